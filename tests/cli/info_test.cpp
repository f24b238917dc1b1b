// SPDX-License-Identifier: MIT
// `kissmap info` of logs without an index: how long they last, how fast and how large their scans
// are, where they are on earth.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "formats/support.hpp"
#include "formats/turning_capture.hpp"
#include "support/program.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::Bytes;
using test::TempDir;
using test::turning_capture;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string told(const fs::path& log, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{KISSMAP_BINARY, "info", log.string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const ProgramResult result = run_program(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.out;
}

// 750 packets, 1.333 ms each, make ten turns of 75.
TEST(Info, OfACaptureTellsDurationRateAndSize) {
  const TempDir dir;
  const fs::path file = dir.write("drive.pcap", turning_capture(750));
  EXPECT_THAT(told(file),
              AllOf(HasSubstr("  sensor      Velodyne VLP-16\n"),
                    HasSubstr("  duration    0.998 s\n"),
                    HasSubstr("the first 5 scans: 28,800 returns each, 10.00 scans a second"),
                    HasSubstr("  topic       2368 (Velodyne packets)\n"),
                    Not(HasSubstr("georeference"))));
  EXPECT_THAT(told(file, {"--all"}),
              AllOf(HasSubstr("10 scans, 288,000 returns, 0.900 s, 10.00 scans a second"),
                    HasSubstr("  per scan    28,800 returns\n"),
                    Not(HasSubstr("the first"))));
}

TEST(Info, OfACaptureTellsOfPositionPackets) {
  const TempDir dir;
  const std::string fix = "$GPRMC,221320,A,4807.038,N,01131.000,E,022.4,084.4,141123,003.1,W*6A";
  const std::string position = test::datagram_record(500, 8308, test::position_payload(fix));
  EXPECT_THAT(told(dir.write("drive.pcap", turning_capture(160) + position)),
              HasSubstr("  georeference topic 8308\n"));
}

// An MCAP file of velodyne_msgs/VelodyneScan without a summary, 50 packets a message.
TEST(Info, OfPacketsInABagTellsRateAndSize) {
  const auto text32 = [](const std::string& text) {
    return Bytes().add<std::uint32_t>(static_cast<std::uint32_t>(text.size())).text() + text;
  };
  const auto record = [](std::uint8_t op, const std::string& content) {
    return Bytes().add<std::uint8_t>(op).add<std::uint64_t>(content.size()).text() + content;
  };
  const std::string magic("\x89MCAP0\r\n", 8);
  std::string file =
      magic + record(1, text32("ros1") + text32("")) +
      record(3,
             Bytes().add<std::uint16_t>(1).text() + text32("velodyne_msgs/VelodyneScan") +
                 text32("ros1msg") + text32("")) +
      record(4,
             Bytes().add<std::uint16_t>(0).add<std::uint16_t>(1).text() +
                 text32("/velodyne_packets") + text32("ros1") + text32(""));
  const auto stamp = [](std::int64_t us) {
    return Bytes()
        .add<std::uint32_t>(static_cast<std::uint32_t>(test::turn_start_s + us / 1'000'000))
        .add<std::uint32_t>(static_cast<std::uint32_t>(us % 1'000'000 * 1000))
        .text();
  };
  for (int first = 0; first < 750; first += 50) {
    std::string message = Bytes().add<std::uint32_t>(0).text() +
                          stamp(first * test::turn_packet_us) + text32("velodyne") +
                          Bytes().add<std::uint32_t>(50).text();
    for (int i = first; i < first + 50; ++i) {
      const std::string datagram = test::turning_record(i);
      message += stamp(i * test::turn_packet_us) + datagram.substr(datagram.size() - 1206);
    }
    const auto ns = static_cast<std::uint64_t>(test::turn_start_s * 1'000'000'000 +
                                               first * test::turn_packet_us * 1000);
    file += record(5,
                   Bytes().add<std::uint16_t>(0)
                           .add<std::uint32_t>(0)
                           .add<std::uint64_t>(ns)
                           .add<std::uint64_t>(ns)
                           .text() +
                       message);
  }
  file +=
      record(15, Bytes().add<std::uint32_t>(0).text()) + record(2, std::string(20, '\0')) + magic;
  const TempDir dir;
  EXPECT_THAT(told(dir.write("drive.mcap", file)),
              AllOf(HasSubstr("  duration    0.933 s\n"),  // 700 packets from first to last
                    HasSubstr("the first 5 scans: 28,800 returns each, 10.00 scans a second")));
}

// LVX 1.1 of one sensor that is not mounted: 40 frames of 50 ms, each a packet of 96 points at its
// beginning and one 48 ms later.
std::string lvx_file() {
  const auto packet = [](std::uint64_t ms) {
    Bytes bytes;
    bytes.add<std::uint8_t>(0).pad(9).add<std::uint8_t>(2);
    bytes.add<std::uint64_t>(5'000'000'000 + ms * 1'000'000);
    for (int i = 0; i < 96; ++i) {
      bytes.add<std::int32_t>(1000).add<std::int32_t>(2000).add<std::int32_t>(3000);
      bytes.add<std::uint16_t>(7);
    }
    return bytes.text();
  };
  std::string file = "livox_tech" + std::string(6, '\0') + std::string("\x01\x01\0\0", 4) +
                     Bytes().add<std::uint32_t>(0xAC0EA767).add<std::uint32_t>(50).text() + '\x01' +
                     std::string(32 + 2 + 1 + 24, '\0');
  for (std::uint64_t i = 0; i < 40; ++i) {
    const std::string body = packet(i * 50) + packet(i * 50 + 48);
    const std::uint64_t next = i == 39 ? 0 : file.size() + 24 + body.size();
    file += Bytes()
                .add<std::uint64_t>(file.size())
                .add<std::uint64_t>(next)
                .add<std::uint64_t>(i)
                .text();
    file += body;
  }
  return file;
}

TEST(Info, OfALivoxFileTellsDurationRateAndSize) {
  const TempDir dir;
  EXPECT_THAT(told(dir.write("walk.lvx", lvx_file())),
              AllOf(HasSubstr("  duration    1.950 s\n"),
                    // Three frames are the first that span 0.1 s.
                    HasSubstr("the first 5 scans: 576 returns each, 6.67 scans a second")));
}

// Packets of 12 hits on a circle, 180 a turn, 555 us each.
TEST(Info, OfTheHitsOfNcltTellsDurationRateAndFixes) {
  std::string file;
  for (int packet = 0; packet < 1'100; ++packet) {
    Bytes bytes;
    for (int i = 0; i < 4; ++i) bytes.add<std::uint16_t>(44'444);
    bytes.add<std::uint32_t>(12).add<std::uint64_t>(1'357'847'239'000'000 +
                                                    static_cast<std::uint64_t>(packet) * 555);
    bytes.add<std::uint32_t>(0);
    for (int i = 0; i < 12; ++i) {
      const double angle = (packet * 2.0 + i * 2.0 / 12) * M_PI / 180.0;
      const auto raw = [](double m) { return static_cast<std::uint16_t>((m + 100.0) / 0.005); };
      bytes.add<std::uint16_t>(raw(10 * std::cos(angle)))
          .add<std::uint16_t>(raw(10 * std::sin(angle)))
          .add<std::uint16_t>(raw(1.0))
          .add<std::uint16_t>(50);
    }
    file += bytes.text();
  }
  const TempDir dir;
  dir.write("gps.csv", "1,2,3\n");
  EXPECT_THAT(
      told(dir.write("velodyne_hits.bin", file)),
      AllOf(HasSubstr("  duration    0.610 s\n"),  // 1,099 packets
            testing::ContainsRegex("2,1[0-9][0-9] returns each, (9.9|10.0)[0-9] scans a second"),
            HasSubstr("  georeference gps.csv (latitude, longitude, height)\n")));
}

TEST(Info, OfAFolderTellsDurationAndRateByItsStamps) {
  const TempDir dir;
  for (int i = 0; i < 5; ++i) {
    dir.write("170000000" + std::to_string(i) + ".500000000.xyz", "1 2 3\n4 5 6\n");
  }
  EXPECT_THAT(told(dir.path()), HasSubstr("  duration    4.000 s, 1.00 scans a second\n"));
}

// A LAS header with one record of the projection: keys of GeoTIFF.
std::string las_with_keys(std::uint16_t key, std::uint16_t value, std::uint16_t record_id) {
  std::string header = "LASF" + std::string(371, '\0');
  const auto put = [&](std::size_t at, const std::string& bytes) {
    header.replace(at, bytes.size(), bytes);
  };
  const std::string keys = Bytes()
                               .add<std::uint16_t>(1)
                               .add<std::uint16_t>(1)
                               .add<std::uint16_t>(0)
                               .add<std::uint16_t>(1)
                               .add<std::uint16_t>(key)
                               .add<std::uint16_t>(0)
                               .add<std::uint16_t>(1)
                               .add<std::uint16_t>(value)
                               .text();
  header.resize(227);
  const std::string record = std::string(2, '\0') + "LASF_Projection" + '\0' +
                             Bytes()
                                 .add<std::uint16_t>(record_id)
                                 .add<std::uint16_t>(static_cast<std::uint16_t>(keys.size()))
                                 .text() +
                             std::string(32, '\0') + keys;
  put(24, std::string("\x01\x02", 2));
  put(94, Bytes().add<std::uint16_t>(227).text());
  put(96, Bytes().add<std::uint32_t>(static_cast<std::uint32_t>(227 + record.size())).text());
  put(100, Bytes().add<std::uint32_t>(1).text());
  put(104, std::string("\0\x14\0", 3) + Bytes().add<std::uint32_t>(2).text());
  for (std::size_t axis = 0; axis < 3; ++axis) put(131 + 8 * axis, Bytes().add<double>(1).text());
  Bytes points;
  for (int i = 1; i <= 6; ++i) {
    points.add<std::int32_t>(i);
    if (i % 3 == 0) points.add<std::uint64_t>(0);
  }
  return header + record + points.text();
}

TEST(Info, OfLasFilesTellsTheirCoordinateSystem) {
  const TempDir dir;
  EXPECT_THAT(told(dir.write("1.las", las_with_keys(3072, 32632, 34735))),
              HasSubstr("  georeference coordinate system of 1.las (EPSG:32632)\n"));
  EXPECT_THAT(told(dir.write("1.las", las_with_keys(3072, 32767, 34735))),
              HasSubstr("coordinate system of 1.las (keys of its own)\n"));
  EXPECT_THAT(told(dir.write("1.las", las_with_keys(0, 0, 2112))),
              HasSubstr("coordinate system of 1.las (WKT)\n"));
  EXPECT_THAT(told(dir.write("1.las", las_with_keys(3072, 32632, 5))),
              Not(HasSubstr("georeference")));
}

}  // namespace
}  // namespace kissmap
