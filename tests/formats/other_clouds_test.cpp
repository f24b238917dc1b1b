// SPDX-License-Identifier: MIT
// Clouds as NumPy arrays (written by NumPy), as text and as LAS.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/clouds/las_reader.hpp"
#include "formats/clouds/npy.hpp"
#include "formats/clouds/refusal.hpp"
#include "formats/clouds/text_cloud.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

using test::Bytes;
using test::bytes_of;
using test::read_all;
using test::run;
using test::scan_of;
using test::TempDir;
using testing::HasSubstr;

Scan only_scan(const std::filesystem::path& path) {
  const auto entries = read_all(*open_log(path));
  if (entries.size() != 1) throw std::runtime_error(std::to_string(entries.size()) + " scans");
  return scan_of(entries[0]);
}

// Point i is (1 + i, 2, -i / 8) with intensity i % 50.
void expect_points(const Scan& scan, bool with_intensity) {
  ASSERT_EQ(scan.points.size(), 300U);
  for (std::size_t i = 0; i < 300; ++i) {
    const auto k = static_cast<float>(i);
    ASSERT_EQ(scan.points[i], Eigen::Vector3f(1 + k, 2, -k / 8)) << i;
    if (!with_intensity) continue;
    ASSERT_EQ(scan.intensities[i], static_cast<float>(i % 50)) << i;
  }
  EXPECT_EQ(scan.intensities.empty(), !with_intensity);
}

TEST(NpyClouds, OfEveryTypeOrderAndLayout) {
  const TempDir dir;
  const std::string script =
      "import numpy as n, sys\n"
      "i = n.arange(300.0); a = n.stack([1+i, 0*i+2, -i/8, i%50], 1); d = sys.argv[1]\n"
      "for t in ['<f4','<f8','>f4','>f8']:\n"
      "  for o in 'CF':\n"
      "    n.save(f'{d}/a_{o}_{t[1:]}{ord(t[0])}.npy', n.array(a, dtype=t, order=o))\n"
      "n.save(d+'/b_1.npy', a[:, :3].astype('<f4'))\n"
      "s = n.zeros(300, "
      "dtype=[('t','<f8'),('intensity','<u2'),('x','<f4'),('y','<f4'),('z','<f8')])\n"
      "s['x'],s['y'],s['z'],s['intensity'],s['t'] = a[:,0],a[:,1],a[:,2],a[:,3],i*1e-4\n"
      "n.save(d+'/c_1.npy', s)\n";
  dir.write("script.py", script);
  run(std::string(KISSMAP_TEST_PYTHON) + " " + (dir.path() / "script.py").string() + " " +
      dir.path().string());
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(dir.path())) {
    if (entry.path().extension() != ".npy") continue;
    SCOPED_TRACE(entry.path().filename().string());
    const char group = entry.path().filename().string()[0];
    const Scan scan = only_scan(entry.path());
    expect_points(scan, group != 'b');
    EXPECT_EQ(scan.time_offsets.size(), group == 'c' ? 300U : 0U);
    ++read;
    if (group != 'c') continue;
    EXPECT_NEAR(scan.time_offsets[299], 0.0299, 1e-7);
  }
  EXPECT_EQ(read, 10);
}

template <class Read>
std::string reason_of(Read read, const std::string& content) {
  try {
    read(bytes_of(content));
  } catch (const Refusal& refusal) {
    return std::string(refusal.reason()) + ": " + refusal.what();
  }
  return "read";
}

std::string npy(const std::string& dictionary, const std::string& data) {
  const auto size = static_cast<std::uint16_t>(dictionary.size());
  return "\x93NUMPY\x01" + std::string(1, '\0') + Bytes().add<std::uint16_t>(size).text() +
         dictionary + data;
}

TEST(NpyClouds, HostileHeadersAreRefused) {
  const std::string data(120, 'x');
  const std::pair<std::string, std::string> cases[] = {
      {npy("{'descr': '<f4', 'fortran_order': False, 'shape': (1000000000000, 3), }", data),
       "truncated"},
      {npy("{'descr': '<f4', 'fortran_order': False, 'shape': (10,), }", data), "shape"},
      {npy("{'descr': '<f4', 'fortran_order': False, 'shape': (10, 2), }", data), "shape"},
      {npy("{'descr': '|O', 'fortran_order': False, 'shape': (10, 3), }", data), "'O'"},
      {npy("{'descr': '<f4', 'shape': (10, 3), }", data), "fortran_order"},
      {npy("{'descr': [('x', '<f4'), ('y', ", data), "fortran_order"},
      {npy("", data), "descr"},
      {"\x93NUMPY\x09" + std::string(1, '\0') + data, "version"},
      {std::string("\x93NUMPY\x01\x00\xff\xff{", 11), "truncated"}};
  for (const auto& [content, part] : cases) {
    EXPECT_THAT(reason_of(read_npy, content), HasSubstr(part));
  }
}

TEST(TextClouds, WithAnySeparatorAndNamesInAnyOrder) {
  const TempDir dir;
  for (const std::string separator : {" ", "\t", ",", " ; ", ", "}) {
    std::string plain = "# remark\n\n// another\n";
    std::string named =
        "intensity" + separator + "z" + separator + "Y" + separator + "x" + separator + "time\r\n";
    for (int i = 0; i < 300; ++i) {
      const std::string x = std::to_string(1 + i);
      const std::string z = std::to_string(-i / 8.0);
      const std::string intensity = std::to_string(i % 50);
      plain += x + separator + "2" + separator + z + separator + intensity + "\n";
      named += intensity + separator + z + separator + "2" + separator + x + separator +
               std::to_string(1e-4 * i) + "\r\n";
    }
    expect_points(only_scan(dir.write("cloud1.xyz", plain)), true);
    const Scan scan = only_scan(dir.write("cloud1.csv", named));
    expect_points(scan, true);
    ASSERT_EQ(scan.time_offsets.size(), 300U);
    EXPECT_NEAR(scan.time_offsets[299], 0.0299, 1e-7);
  }
}

TEST(TextClouds, TablesBesideCloudsAreNotClouds) {
  const TempDir dir;
  dir.write("cloud1.xyz", "1 2 3\n");
  dir.write("poses.csv", "a,b\n");
  EXPECT_EQ(only_scan(dir.path()).points.size(), 1U);
}

TEST(TextClouds, DamageIsRefusedWithItsLine) {
  EXPECT_THAT(reason_of(read_text_cloud, "1 2 3\n4 5\n"), HasSubstr("line 2: 2 columns"));
  EXPECT_THAT(reason_of(read_text_cloud, "1 2 3\n4 5 six\n"), HasSubstr("line 2: 'six'"));
  EXPECT_THAT(reason_of(read_text_cloud, "1 2\n"), HasSubstr("line 1: 2 columns"));
  EXPECT_EQ(reason_of(read_text_cloud, ""), "read");
}

std::string las(std::uint8_t minor,
                std::uint8_t format,
                std::uint16_t record,
                std::uint32_t points) {
  std::string header(227, '\0');
  const auto put = [&](std::size_t at, const std::string& bytes) {
    header.replace(at, bytes.size(), bytes);
  };
  put(0, "LASF");
  header[24] = 1;
  header[25] = static_cast<char>(minor);
  put(94, Bytes().add<std::uint16_t>(227).add<std::uint32_t>(227).text());
  header[104] = static_cast<char>(format);
  put(105, Bytes().add<std::uint16_t>(record).add<std::uint32_t>(points).text());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put(131 + 8 * axis, Bytes().add<double>(0.001).text());
    put(155 + 8 * axis, Bytes().add<double>(axis == 0 ? 1.0 : 0.0).text());
  }
  for (std::uint32_t i = 0; i < points; ++i) {
    const auto k = static_cast<std::int32_t>(i);
    Bytes point;
    point.add<std::int32_t>(k * 1000).add<std::int32_t>(2000).add<std::int32_t>(-k * 125);
    point.add<std::uint16_t>(static_cast<std::uint16_t>(i % 50));
    std::string bytes = point.text();
    bytes.resize(record, '\0');
    header += bytes;
  }
  return header;
}

TEST(LasClouds, OfEveryPointFormat) {
  const TempDir dir;
  const std::uint16_t sizes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  for (std::uint8_t format = 0; format <= 10; ++format) {
    SCOPED_TRACE(int{format});
    const auto extra = static_cast<std::uint16_t>(sizes[format] + 5);
    expect_points(only_scan(dir.write("cloud.las", las(2, format, extra, 300))), true);
  }
}

TEST(LasClouds, CompressedAndBrokenOnesAreRefused) {
  EXPECT_THAT(reason_of(read_las, las(2, 0x80, 20, 3)), HasSubstr("LAZ"));
  EXPECT_THAT(reason_of(read_las, las(2, 11, 70, 3)), HasSubstr("point format 11"));
  EXPECT_THAT(reason_of(read_las, las(2, 3, 20, 3)), HasSubstr("records of 20 bytes"));
  EXPECT_THAT(reason_of(read_las, las(2, 0, 20, 3).substr(0, 280)), HasSubstr("truncated"));
  EXPECT_THAT(reason_of(read_las, las(2, 0, 20, 3).substr(0, 100)), HasSubstr("truncated"));
}

}  // namespace
}  // namespace kissmap
