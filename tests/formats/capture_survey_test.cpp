// SPDX-License-Identifier: MIT
// What is told of a capture before it is read: from when to when it lasts, where fixes are, whose
// packets are refused.
#include "formats/logs/capture_survey.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/hesai_packets.hpp"
#include "formats/sparse_containers.hpp"
#include "formats/support.hpp"
#include "formats/turning_capture.hpp"
#include "kissmap/formats/georeference.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::Bytes;
using test::datagram_record;
using test::error_of;
using test::position_payload;
using test::TempDir;
using test::turning_capture;
using test::turning_record;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::Optional;

using Range = std::pair<std::int64_t, std::int64_t>;

constexpr std::int64_t start_ns = test::turn_start_s * 1'000'000'000;
constexpr std::int64_t packet_ns = test::turn_packet_us * 1000;

const std::string capture_head = test::pcap_head(1, std::endian::little, 0xA1B2C3D4);

TEST(CaptureTimes, AreThoseOfTheFirstAndLastPacketOfTheSensor) {
  const TempDir dir;
  const std::string other = datagram_record(9'000'000, 9'999, "other traffic");
  const auto log = open_log(dir.write("c.pcap", turning_capture(200) + other));
  EXPECT_THAT(log->info().time_range, Optional(Range(start_ns, start_ns + 199 * packet_ns)));
}

TEST(CaptureTimes, OfACutFileEndWithItsLastWholePacket) {
  const TempDir dir;
  const std::string file = turning_capture(100);
  for (const std::size_t cut : {1U, 20U, 1000U}) {
    const auto log = open_log(dir.write("c.pcap", file.substr(0, file.size() - cut)));
    EXPECT_THAT(log->info().time_range, Optional(Range(start_ns, start_ns + 98 * packet_ns)));
  }
}

TEST(CaptureTimes, OfOnePacketAreNone) {
  const TempDir dir;
  EXPECT_EQ(open_log(dir.write("c.pcap", turning_capture(1)))->info().time_range, std::nullopt);
}

// A hole of 20 GB between what is looked at first and the last packets.
TEST(CaptureTimes, OfALargeFileTakeLittleReading) {
  const TempDir dir;
  const fs::path path = dir.path() / "large.pcap";
  constexpr int packets = 20'000;
  std::ofstream file(path, std::ios::binary);
  file << turning_capture(packets);
  file.seekp(20'000'000'000);
  for (int i = 0; i < 5'000; ++i) file << turning_record(packets + i);
  file.close();
  const std::uint64_t before = test::sparse::bytes_read();
  const auto log = open_log(path);
  EXPECT_THAT(log->info().time_range,
              Optional(Range(start_ns, start_ns + (packets + 4'999) * packet_ns)));
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(test::scan_of(*log->next()).points.size(), 28'800U);
  }
  EXPECT_LT(test::sparse::bytes_read() - before, test::sparse::most_bytes);
}

std::string pcapng_block(std::uint32_t type, std::string body) {
  body.resize((body.size() + 3) / 4 * 4, '\0');
  const std::string size =
      Bytes().add<std::uint32_t>(static_cast<std::uint32_t>(body.size() + 12)).text();
  return Bytes().add<std::uint32_t>(type).text() + size + body + size;
}

// Of the first interface, whose times are in us.
std::string pcapng_packet(int number) {
  const std::string frame = turning_record(number).substr(16);
  const auto us =
      static_cast<std::uint64_t>(test::turn_start_s * 1'000'000 + number * test::turn_packet_us);
  const auto size = static_cast<std::uint32_t>(frame.size());
  return pcapng_block(6,
                      Bytes().add<std::uint32_t>(0)
                              .add<std::uint32_t>(static_cast<std::uint32_t>(us >> 32U))
                              .add<std::uint32_t>(static_cast<std::uint32_t>(us))
                              .add<std::uint32_t>(size)
                              .add<std::uint32_t>(size)
                              .text() +
                          frame);
}

TEST(CaptureTimes, OfPcapngAreFoundByItsBlocks) {
  const TempDir dir;
  const fs::path path = dir.path() / "large.pcapng";
  std::ofstream file(path, std::ios::binary);
  file << pcapng_block(0x0A0D0D0A,
                       Bytes().add<std::uint32_t>(0x1A2B3C4D).add<std::uint32_t>(1).text() +
                           std::string(8, '\xff'))
       << pcapng_block(1, Bytes().add<std::uint32_t>(1).add<std::uint32_t>(0).text());
  for (int i = 0; i < 100; ++i) file << pcapng_packet(i);
  file.seekp(3'000'000'000);
  for (int i = 100; i < 5'100; ++i) file << pcapng_packet(i);
  file.close();
  EXPECT_THAT(last_received(path, 2368), Optional(start_ns + 5'099 * packet_ns));
  EXPECT_EQ(last_received(path, 2369), std::nullopt);
}

TEST(CaptureFixes, AreFoundInPositionPackets) {
  const std::string fix = "$GPRMC,221320,A,4807.038,N,01131.000,E,022.4,084.4,141123,003.1,W*6A";
  const std::string none = "$GPRMC,221320,V,,,,,,,141123,,,N*53";
  const std::string height = "$GNGGA,221320,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47";
  const std::string no_height = "$GNGGA,221320,,,,,0,00,99.9,,,,,,*47";
  for (const auto& [sentence, type] : {std::pair(fix, "NMEA sentences"),
                                       std::pair(none, "NMEA sentences without a fix"),
                                       std::pair(height, "NMEA sentences"),
                                       std::pair(no_height, "NMEA sentences without a fix")}) {
    const TempDir dir;
    const std::string position = datagram_record(300, 8308, position_payload(sentence));
    const auto log = open_log(dir.write("c.pcap", turning_capture(80) + position));
    const auto& topics = log->info().topics;
    ASSERT_EQ(topics.size(), 2U);
    EXPECT_EQ(topics[0].name, "2368");
    EXPECT_EQ(topics[0].type, "Velodyne packets");
    EXPECT_EQ(topics[1].name, "8308");
    EXPECT_EQ(topics[1].type, type);
    const bool with_fix = topics[1].type == "NMEA sentences";
    const auto places = find_georeference(log->info(), "");
    EXPECT_EQ(places,
              with_fix ? std::vector<std::string>{"topic 8308"} : std::vector<std::string>{});
  }
}

TEST(CaptureFixes, AreNotMadeUp) {
  for (const std::string text : {"$GPVTG,A,1,A", "$G", "$GPRMC", "", "GPRMC,1,A"}) {
    const TempDir dir;
    const std::string other = datagram_record(300, 8308, position_payload(text));
    const auto log = open_log(dir.write("c.pcap", turning_capture(80) + other));
    EXPECT_THAT(find_georeference(log->info(), ""), IsEmpty()) << text;
  }
}

std::string captured(const std::string& payload, std::uint16_t port) {
  std::string file = capture_head;
  for (int i = 0; i < 10; ++i) file += datagram_record(i * 1000, port, payload);
  return file;
}

std::string text_of_bytes(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string filled(const std::string& begin, std::size_t size) {
  return begin + std::string(size - begin.size(), '\x2A');
}

std::string refusal_of_capture(const std::string& payload) {
  const TempDir dir;
  return error_of(Fault::input, [&] { open_log(dir.write("c.pcap", captured(payload, 6699))); });
}

TEST(ForeignSensors, OfRoboSenseAreNamed) {
  const std::string rs_16("\x55\xAA\x05\x0A\x5A\xA5\x50\xA0", 8);
  const auto hint = AllOf(HasSubstr("PCD"), HasSubstr("rslidar_sdk"), HasSubstr("c.pcap"));
  EXPECT_THAT(refusal_of_capture(filled(rs_16, 1248)), AllOf(HasSubstr("RS-LiDAR-16"), hint));
  EXPECT_THAT(refusal_of_capture(filled("\x55\xAA\x05\x5A", 1248)),
              AllOf(HasSubstr("RoboSense of the Ruby"), hint));
  EXPECT_THAT(refusal_of_capture(filled("\x55\xAA\x5A\xA5", 1210)),
              AllOf(HasSubstr("RoboSense of the M or E series"), hint));
}

// Version, its own length, shots of 14 bytes, their kind.
std::string mid_360_payload(std::size_t shots) {
  const std::size_t size = 36 + shots * 14;
  return filled(Bytes()
                    .add<std::uint8_t>(0)
                    .add<std::uint16_t>(static_cast<std::uint16_t>(size))
                    .add<std::uint16_t>(4800)
                    .add<std::uint16_t>(static_cast<std::uint16_t>(shots))
                    .add<std::uint16_t>(7)
                    .add<std::uint8_t>(3)
                    .add<std::uint8_t>(1)
                    .text(),
                size);
}

TEST(ForeignSensors, OfLivoxAreNamed) {
  EXPECT_THAT(
      refusal_of_capture(mid_360_payload(96)),
      AllOf(HasSubstr("Mid-360"), HasSubstr("livox_ros_driver2"), Not(HasSubstr("Ouster"))));
  const std::string avia = "\x05" + std::string(8, '\0') + "\x02";
  EXPECT_THAT(refusal_of_capture(filled(avia, 18 + 96 * 14)),
              AllOf(HasSubstr("Avia"), HasSubstr("Livox Viewer")));
  EXPECT_THAT(refusal_of_capture(mid_360_payload(96) + "x"), HasSubstr("Ouster"))
      << "its length does not fit";
}

TEST(ForeignSensors, OfHesaiAreNamedByTheirProtocol) {
  const auto refusal = [](unsigned major, unsigned minor, unsigned lasers, unsigned blocks) {
    return refusal_of_capture(text_of_bytes(test::HesaiPacketBytes(test::xt_32_kind, 0x37)
                                                .put(2, major)
                                                .put(3, minor)
                                                .put(6, lasers)
                                                .put(7, blocks)
                                                .bytes()));
  };
  const auto hint = AllOf(HasSubstr("PCD"), HasSubstr("PandarView"));
  EXPECT_THAT(refusal(1, 4, 128, 2), AllOf(HasSubstr("Pandar128"), HasSubstr("1.4"), hint));
  EXPECT_THAT(refusal(4, 3, 128, 2), AllOf(HasSubstr("AT128"), HasSubstr("4.3"), hint));
  EXPECT_THAT(refusal(3, 1, 64, 4), AllOf(HasSubstr("QT64"), hint));
  EXPECT_THAT(refusal(5, 1, 64, 4), AllOf(HasSubstr("QT64"), HasSubstr("5.1"), hint));
  EXPECT_THAT(refusal(7, 2, 160, 1), AllOf(HasSubstr("FT120"), hint));
  EXPECT_THAT(refusal(9, 9, 7, 5),
              AllOf(HasSubstr("unknown model"), HasSubstr("9.9, 7 lasers in 5 blocks"), hint));
  EXPECT_THAT(refusal(6, 1, 31, 8), AllOf(HasSubstr("6.1, 31 lasers"), hint));
}

TEST(ForeignSensors, OfVelodyneHaveACure) {
  for (const auto& [product, name] :
       {std::pair(0x23U, "VLP-32A"), std::pair(0x31U, "Velarray"), std::pair(0x77U, "0x77")}) {
    const std::string payload =
        text_of_bytes(test::VelodynePacket(product, 0x37, 1).all_shots(1).bytes());
    EXPECT_THAT(refusal_of_capture(payload),
                AllOf(HasSubstr(name), HasSubstr("PCD"), HasSubstr("VeloView")));
  }
}

TEST(ForeignSensors, BesideOneThatIsReadDoNotMatterUnlessChosen) {
  const TempDir dir;
  std::string file = turning_capture(80);
  for (int i = 0; i < 80; ++i) {
    file += datagram_record(i * 1000, 6699, filled("\x55\xAA\x05\x5A", 1248));
  }
  const fs::path path = dir.write("c.pcap", file);
  EXPECT_EQ(open_log(path)->info().sensor, "Velodyne VLP-16");
  ReadOptions options;
  options.topic = "6699";
  EXPECT_THAT(error_of(Fault::input, [&] { open_log(path, options); }), HasSubstr("RoboSense"));
}

// An Ouster's packets begin with a time, which may be anything.
TEST(ForeignSensors, AreNotTakenForOneByASinglePacket) {
  const TempDir dir;
  std::string file = capture_head;
  for (int i = 0; i < 10; ++i) {
    file += datagram_record(i * 1000, 7502, filled(i == 3 ? "\x55\xAA\x05\x5A" : "1234", 3392));
  }
  EXPECT_THAT(error_of(Fault::input, [&] { open_log(dir.write("c.pcap", file)); }),
              AllOf(HasSubstr("Ouster"), HasSubstr("7502, 3392 bytes: 10"), HasSubstr("c.json")));
}

TEST(ForeignSensors, CompressedLasFilesHaveACure) {
  const TempDir dir;
  dir.write("1.laz", "LASF" + std::string(400, '\0'));
  EXPECT_THAT(error_of(Fault::input, [&] { open_log(dir.path()); }),
              AllOf(HasSubstr("1.laz"), HasSubstr("pdal translate")));
}

}  // namespace
}  // namespace kissmap
