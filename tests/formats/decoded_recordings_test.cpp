// SPDX-License-Identifier: MIT
// Recordings opened as a user would, return by return against decode_recordings.py, which knows the
// published layouts and nothing of kissmap; and packets in ROS 2 bags against those taken out by
// packet_bag.hpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iomanip>
#include <limits>
#include <sstream>

#include "formats/hesai_reference_angles.hpp"
#include "formats/sensor_recording.hpp"
#include "formats/sensors/hesai_decoder.hpp"
#include "formats/sensors/velodyne_decoder.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::read_all;
using test::scan_of;
using test::TempDir;

struct Return {
  double sweep = 0, x = 0, y = 0, z = 0, intensity = 0, time_s = 0;
};

struct Decoded {
  std::int64_t base_ns = 0;
  std::vector<Return> returns;
};

Decoded decode_by_python(const char* kind, const fs::path& recording) {
  const TempDir dir;
  const fs::path out = dir.path() / "returns";
  test::run(std::string(KISSMAP_TEST_PYTHON) +
            " -I " KISSMAP_TEST_SOURCES "/decode_recordings.py " + kind + " " + recording.string() +
            " " + out.string());
  Decoded decoded;
  std::ifstream in(out, std::ios::binary);
  in.read(reinterpret_cast<char*>(&decoded.base_ns), sizeof(decoded.base_ns));
  for (Return r; in.read(reinterpret_cast<char*>(&r), sizeof(r));) decoded.returns.push_back(r);
  return decoded;
}

struct DecodedRecording {
  const char* kind;
  const char* file;
  const char* sensor;
  std::vector<std::size_t> points;  ///< by sweep
  std::int64_t stamp_ns;            ///< of the first
  const char* name;
};

class DecodedRecordings : public testing::TestWithParam<DecodedRecording> {};

// Positions are rounded to 32 bits; absolute times in seconds to 64, which is 0.24 us.
TEST_P(DecodedRecordings, GiveEveryReturn) {
  const char* data = std::getenv("KISSMAP_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "needs the recordings";
  const fs::path file = fs::path(data) / GetParam().file;
  const auto log = open_log(file);
  EXPECT_EQ(log->info().sensor, GetParam().sensor);
  const auto entries = read_all(*log);
  ASSERT_EQ(entries.size(), GetParam().points.size());
  EXPECT_EQ(scan_of(entries[0]).stamp_ns, GetParam().stamp_ns);
  const Decoded decoded = decode_by_python(GetParam().kind, file);
  std::size_t at = 0;
  for (std::size_t sweep = 0; sweep < entries.size(); ++sweep) {
    const Scan& scan = scan_of(entries[sweep]);
    ASSERT_EQ(scan.points.size(), GetParam().points[sweep]);
    ASSERT_EQ(scan.intensities.size(), scan.points.size());
    ASSERT_EQ(scan.time_offsets.size(), scan.points.size());
    EXPECT_EQ(scan.dropped, DroppedReturns());
    EXPECT_EQ(scan.time_source, TimeSource::recorded);
    const double stamp_s = 1e-9 * static_cast<double>(scan.stamp_ns - decoded.base_ns);
    for (std::size_t i = 0; i < scan.points.size(); ++i, ++at) {
      ASSERT_LT(at, decoded.returns.size());
      const Return& expected = decoded.returns[at];
      ASSERT_EQ(expected.sweep, static_cast<double>(sweep));
      const Eigen::Vector3d point(expected.x, expected.y, expected.z);
      ASSERT_LT((scan.points[i].cast<double>() - point).norm(), 1e-6 * point.norm() + 1e-6) << i;
      ASSERT_EQ(scan.intensities[i], static_cast<float>(expected.intensity)) << i;
      ASSERT_NEAR(stamp_s + scan.time_offsets[i], expected.time_s, 6e-7) << i;
    }
  }
  EXPECT_EQ(at, decoded.returns.size());
}

INSTANTIATE_TEST_SUITE_P(
    All,
    DecodedRecordings,
    testing::Values(DecodedRecording{"velodyne",
                                     "packets/velodyne/sample_velodyne_vlp16_gps.pcap",
                                     "Velodyne VLP-16",
                                     {18'566, 18'562, 18'530, 17'828},
                                     1'453'364'282'340'624'952,
                                     "vlp16"},
                    DecodedRecording{"velodyne",
                                     "packets/velodyne/sample_velodyne_hdl32.pcap",
                                     "Velodyne HDL-32E",
                                     {57'674, 57'669, 31'362},
                                     1'319'768'035'374'684'152,
                                     "hdl32"},
                    DecodedRecording{"ouster",
                                     "packets/ouster/512x10_raw.bag",
                                     "Ouster OS-0-128",
                                     {28'751},
                                     1'723'828'414'279'578'824,
                                     "os0_128"},
                    DecodedRecording{"cloud",
                                     "pointcloud2/pandar64_ring_timestamp_5.bag",
                                     "",
                                     {80'787, 80'753, 80'793, 80'764, 80'748},
                                     1'635'236'489'467'999'935,
                                     "pandar64"}),
    [](const auto& recording) { return std::string(recording.param.name); });

void expect_same(const Scan& scan, const Scan& expected) {
  EXPECT_EQ(scan.stamp_ns, expected.stamp_ns);
  EXPECT_TRUE(scan.points == expected.points);
  EXPECT_TRUE(scan.intensities == expected.intensities);
  EXPECT_TRUE(scan.time_offsets == expected.time_offsets);
}

struct PacketBag {
  const char* folder;
  HesaiAngles angles;
};

class PacketBags : public test::PacketRecordings, public testing::WithParamInterface<PacketBag> {
 protected:
  std::vector<Scan> taken_out(const fs::path& folder) const {
    const auto decoder = std::string(GetParam().folder).starts_with("hesai")
                             ? make_hesai_decoder(GetParam().angles)
                             : make_velodyne_decoder();
    for (const auto& packet : test::read_packet_bag(test::only_file(folder, ".db3"))) {
      decoder->add(packet.payload, packet.received_ns);
    }
    decoder->finish();
    return test::take_all(*decoder);
  }
};

/// The angles as the file that comes with a unit.
std::string angle_file(const HesaiAngles& angles) {
  std::ostringstream text;
  text << std::setprecision(std::numeric_limits<double>::max_digits10)
       << "Channel,Elevation,Azimuth\n";
  for (std::size_t i = 0; i < angles.size(); ++i) {
    text << i + 1 << "," << angles[i].elevation_deg << "," << angles[i].azimuth_deg << "\n";
  }
  return text.str();
}

// What the packets hold is compared with the reference's clouds by the tests of the decoders.
TEST_P(PacketBags, GiveTheSweepsOfTheirPackets) {
  const fs::path folder = packets_ / GetParam().folder;
  const TempDir dir;
  ReadOptions options;
  if (!GetParam().angles.empty()) {
    options.calibration = dir.write("angles.csv", angle_file(GetParam().angles)).string();
  }
  const fs::path bag = test::only_file(folder, ".db3").parent_path();
  const auto log = open_log(bag, options);
  EXPECT_EQ(log->info().format, "rosbag2");
  const auto entries = read_all(*log);
  const std::vector<Scan> expected = taken_out(folder);
  ASSERT_GE(expected.size(), 2U);
  ASSERT_EQ(entries.size(), expected.size());
  for (std::size_t i = 0; i < entries.size(); ++i) expect_same(scan_of(entries[i]), expected[i]);
}

INSTANTIATE_TEST_SUITE_P(Recordings,
                         PacketBags,
                         testing::Values(PacketBag{"hesai/xt32", test::reference_xt_32},
                                         PacketBag{"hesai/xt32m", test::reference_xt_32m},
                                         PacketBag{"hesai/64", test::reference_pandar_64},
                                         PacketBag{"hesai/64/all_points", {}},
                                         PacketBag{"hesai/40p", test::reference_pandar_40p},
                                         PacketBag{"hesai/xt16", {}},
                                         PacketBag{"hesai/qt128", {}},
                                         PacketBag{"velodyne/vlp16", {}},
                                         PacketBag{"velodyne/vlp32", {}},
                                         PacketBag{"velodyne/vls128", {}}),
                         [](const auto& bag) {
                           std::string name = bag.param.folder;
                           std::ranges::replace(name, '/', '_');
                           return name;
                         });

}  // namespace
}  // namespace kissmap
