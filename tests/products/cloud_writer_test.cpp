// SPDX-License-Identifier: MIT
// Clouds as others read them: a reader of the specifications (read_cloud.py) and PCL's tools.
#include "kissmap/formats/cloud_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "kissmap/error.hpp"
#include "products/cloud_table.hpp"
#include "support/file_size_limit.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr CloudFields all_fields = {true, true, true, true, true, true};

std::vector<CloudPoint> example_points(std::size_t count, const Eigen::Vector3d& about) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<CloudPoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    MapPoint& p = points[i].point;
    p.position = about + 300.0 * Eigen::Vector3d(unit(random), unit(random), unit(random));
    p.to_sensor = Eigen::Vector3d(10 * unit(random), unit(random), unit(random)).cast<float>();
    p.time = 1'700'000'000.25 + 1e-4 * static_cast<double>(i);
    p.intensity = static_cast<float>(i % 256);
    p.scan_idx = static_cast<std::uint32_t>(70'000 + i);
    points[i].normal = Eigen::Vector3f::UnitX() * static_cast<float>(unit(random));
    points[i].rgb = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i / 2), 255};
  }
  return points;
}

class Writers : public testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_.path() / name; }

  fs::path write(const std::string& name,
                 const std::vector<CloudPoint>& points,
                 CloudWriterOptions options) const {
    options.most_points = std::max<std::uint64_t>(options.most_points, points.size());
    const auto writer = open_cloud_writer(path(name), options);
    for (const CloudPoint& point : points) writer->add(point);
    writer->finish();
    return path(name);
  }

 private:
  TempDir folder_;
};

/// Everything but colours and times, whose columns differ.
void expect_points(const CloudTable& table,
                   const std::vector<CloudPoint>& points,
                   const Eigen::Vector3d& offset,
                   const std::string& normal,
                   const std::string& sensor) {
  ASSERT_EQ(table.rows.size(), points.size());
  const char* axes[] = {"x", "y", "z"};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const MapPoint& p = points[i].point;
    for (int axis = 0; axis < 3; ++axis) {
      const double wanted = p.position[axis] - offset[axis];
      ASSERT_NEAR(table.at(i, axes[axis]), wanted, 2e-5) << i;
      ASSERT_NEAR(
          table.at(i, sensor + axes[axis]), wanted + static_cast<double>(p.to_sensor[axis]), 2e-5);
      ASSERT_EQ(table.at(i, normal + axes[axis]), points[i].normal[axis]);
    }
    ASSERT_EQ(table.at(i, "intensity"), p.intensity);
    ASSERT_EQ(table.at(i, "scan"), p.scan_idx);
  }
}

TEST_F(Writers, PcdHoldsEveryFieldInBothEncodings) {
  const Eigen::Vector3d offset(450'000.0, 5'411'000.0, 0.0);
  const std::vector<CloudPoint> points = example_points(3000, offset);
  CloudWriterOptions options{all_fields, offset};
  for (const bool compress : {false, true}) {
    options.compress = compress;
    const CloudTable table = read_cloud(write("cloud.pcd", points, options));
    EXPECT_THAT(table.names,
                ElementsAre("x",
                            "y",
                            "z",
                            "intensity",
                            "normal_x",
                            "normal_y",
                            "normal_z",
                            "timestamp",
                            "scan",
                            "vp_x",
                            "vp_y",
                            "vp_z",
                            "rgb"));
    expect_points(table, points, offset, "normal_", "vp_");
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto& rgb = points[i].rgb;
      ASSERT_EQ(table.at(i, "timestamp"), points[i].point.time);
      ASSERT_EQ(table.at(i, "rgb"), rgb[0] * 65536 + rgb[1] * 256 + rgb[2]);
    }
    EXPECT_THAT(file_text(path("cloud.pcd")), HasSubstr("add to x y z: 450000 5411000 0 "));
  }
}

TEST_F(Writers, PclReadsBothPcdEncodingsTheSame) {
  const std::vector<CloudPoint> points = example_points(20'000, {1.0, 2.0, 3.0});
  CloudWriterOptions options{all_fields};
  const std::string binary = write("binary.pcd", points, options);
  options.compress = true;
  const std::string compressed = write("compressed.pcd", points, options);
  for (const std::string& file : {binary, compressed}) {
    const ProgramResult result =
        run_program({"pcl_convert_pcd_ascii_binary", file, file + ".txt", "0"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  const std::string text = file_text(binary + ".txt");
  EXPECT_EQ(text, file_text(compressed + ".txt"));
  EXPECT_THAT(text, HasSubstr("POINTS 20000\n"));
  std::istringstream lines(text.substr(text.find("DATA ascii\n") + 11));
  for (const CloudPoint& point : points) {  // PCL prints seven digits
    Eigen::Vector3d p;
    double intensity = 0.0;
    std::string rest;
    lines >> p.x() >> p.y() >> p.z() >> intensity;
    std::getline(lines, rest);
    ASSERT_LT((p - point.point.position).norm(), 1e-3);
    ASSERT_EQ(intensity, point.point.intensity);
  }
}

TEST_F(Writers, PlyHoldsEveryField) {
  const std::vector<CloudPoint> points = example_points(3000, {10.0, 20.0, 30.0});
  const CloudTable table = read_cloud(write("cloud.PLY", points, {all_fields}));
  expect_points(table, points, Eigen::Vector3d::Zero(), "n", "sensor_");
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(table.at(i, "timestamp"), points[i].point.time);
    ASSERT_EQ(table.at(i, "red"), points[i].rgb[0]);
    ASSERT_EQ(table.at(i, "green"), points[i].rgb[1]);
    ASSERT_EQ(table.at(i, "blue"), points[i].rgb[2]);
  }
}

TEST_F(Writers, LasHoldsEveryFieldAndItsOwnBounds) {
  const Eigen::Vector3d offset(450'000.0, 5'411'000.0, -3.0);
  const std::vector<CloudPoint> points = example_points(3000, offset);
  CloudWriterOptions options{all_fields, offset};
  options.most_intensity = 255.0F;
  const CloudTable table = read_cloud(write("cloud.las", points, options));
  ASSERT_EQ(table.rows.size(), points.size());
  const char* axes[] = {"x", "y", "z"};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const MapPoint& p = points[i].point;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string name = axes[axis];
      ASSERT_NEAR(table.at(i, name), p.position[axis], 0.000501);
      ASSERT_EQ(table.at(i, "normal_" + name), points[i].normal[axis]);
      ASSERT_EQ(table.at(i, "sensor_" + name),
                p.position[axis] + static_cast<double>(p.to_sensor[axis]));
    }
    ASSERT_EQ(table.at(i, "intensity"), 257.0 * p.intensity);
    ASSERT_EQ(table.at(i, "scan"), p.scan_idx);
    ASSERT_NEAR(table.at(i, "time"), p.time - 315'964'800.0 + 18.0 - 1e9, 1e-6);
    ASSERT_EQ(table.at(i, "red"), 257.0 * points[i].rgb[0]);
    ASSERT_EQ(table.at(i, "blue"), 65535.0);
  }
  auto header = las_header_of(path("cloud.las"));
  EXPECT_EQ(header["version"], "1 2");
  EXPECT_EQ(header["encoding"], "1") << "adjusted standard GPS time";
  EXPECT_EQ(header["format"], "3");
  EXPECT_EQ(header["returns"], "3000 0 0 0 0");
  EXPECT_EQ(header["scale"], "0.001 0.001 0.001");
  EXPECT_EQ(header["offset"], "450000.0 5411000.0 -3.0");
}

TEST_F(Writers, LasTakesTheFormatThatHoldsNoMore) {
  const std::vector<CloudPoint> points = example_points(10, {0.0, 0.0, 0.0});
  for (int format = 0; format < 4; ++format) {
    CloudWriterOptions options;
    options.fields.time = (format & 1) != 0;
    options.fields.rgb = (format & 2) != 0;
    options.unix_time = false;
    const CloudTable table = read_cloud(write("cloud.las", points, options));
    auto header = las_header_of(path("cloud.las"));
    EXPECT_EQ(header["format"], std::to_string(format));
    EXPECT_EQ(header["encoding"], "0");
    EXPECT_EQ(header["begin"], "227") << "nothing between header and points";
    EXPECT_EQ(table.at(3, "intensity"), 0.0);
    EXPECT_EQ(!options.fields.time || table.at(3, "time") == points[3].point.time, true);
  }
}

TEST_F(Writers, LasIntensityFills16Bits) {
  for (const auto& [most, step] : {std::pair{1.0F, 65535.0}, {200.0F, 257.0}, {3000.0F, 1.0}}) {
    std::vector<CloudPoint> points = example_points(3, {0.0, 0.0, 0.0});
    points[0].point.intensity = 0.0F;
    points[1].point.intensity = 1.0F;
    points[2].point.intensity = std::numeric_limits<float>::quiet_NaN();
    CloudWriterOptions options;
    options.fields.intensity = true;
    options.most_intensity = most;
    const CloudTable table = read_cloud(write("cloud.las", points, options));
    EXPECT_EQ(table.at(0, "intensity"), 0.0);
    EXPECT_EQ(table.at(1, "intensity"), step);
    EXPECT_EQ(table.at(2, "intensity"), 0.0);
  }
}

TEST_F(Writers, LasIsVersion4WhereMorePointsMayComeThan32BitsCount) {
  const std::vector<CloudPoint> points = example_points(100, {0.0, 0.0, 0.0});
  CloudWriterOptions options{all_fields};
  options.most_points = 5'000'000'000;
  EXPECT_EQ(read_cloud(write("cloud.las", points, options)).rows.size(), 100U);
  auto header = las_header_of(path("cloud.las"));
  EXPECT_EQ(header["version"], "1 4");
  EXPECT_EQ(header["legacy"], "100");
  EXPECT_EQ(header["points"], "100");
  EXPECT_EQ(header["wide_returns"], "100 0 0 0 0 0 0 0 0 0 0 0 0 0 0");
}

TEST_F(Writers, HoldNoPointsAndOnePoint) {
  for (const char* name : {"cloud.pcd", "cloud.ply", "cloud.las"}) {
    for (const std::size_t count : {0U, 1U}) {
      for (const bool compress : {false, true}) {
        CloudWriterOptions options;
        options.compress = compress;
        const auto points = example_points(count, {0.0, 0.0, 0.0});
        EXPECT_EQ(read_cloud(write(name, points, options)).rows.size(), count) << name;
      }
    }
  }
}

TEST_F(Writers, GiveTheSameBytesForTheSamePoints) {
  const std::vector<CloudPoint> points = example_points(5000, {0.0, 0.0, 0.0});
  for (const std::string ending : {".pcd", ".ply", ".las"}) {
    CloudWriterOptions options{all_fields};
    options.compress = true;
    EXPECT_EQ(file_text(write("a" + ending, points, options)),
              file_text(write("b" + ending, points, options)));
  }
}

TEST_F(Writers, LeaveTheOldFileUntilTheNewOneIsComplete) {
  for (const std::string name : {"cloud.pcd", "cloud.ply", "cloud.las"}) {
    std::ofstream(path(name)) << "old";
    {
      const auto writer = open_cloud_writer(path(name), {});
      writer->add(CloudPoint{});
      EXPECT_TRUE(fs::exists(path(name + ".partial")));
    }
    EXPECT_EQ(file_text(path(name)), "old");
    EXPECT_FALSE(fs::exists(path(name + ".partial")));
  }
}

template <class Call>
Fault fault_of(Call&& call, std::string& message) {
  try {
    call();
  } catch (const Error& error) {
    message = error.what();
    return error.fault();
  }
  ADD_FAILURE() << "no error";
  return Fault::internal;
}

TEST_F(Writers, AFullDiskIsNamedAndLeavesNothing) {
  const std::vector<CloudPoint> points = example_points(30'000, {0.0, 0.0, 0.0});
  for (const std::string name : {"cloud.pcd", "cloud.ply", "cloud.las"}) {
    for (const bool compress : {false, true}) {
      std::string message;
      CloudWriterOptions options{all_fields};
      options.compress = compress;
      const FileSizeLimit full(300'000);
      EXPECT_EQ(fault_of([&] { write(name, points, options); }, message), Fault::output);
      EXPECT_THAT(message, HasSubstr(name));
      EXPECT_THAT(message, HasSubstr("free some space"));
      EXPECT_FALSE(fs::exists(path(name)));
      EXPECT_FALSE(fs::exists(path(name + ".partial")));
    }
  }
}

TEST_F(Writers, RefuseWhatCannotBeWritten) {
  std::string message;
  CloudPoint nowhere;
  nowhere.point.position.y() = std::numeric_limits<double>::quiet_NaN();
  for (const char* name : {"cloud.pcd", "cloud.ply", "cloud.las"}) {
    EXPECT_EQ(fault_of([&] { write(name, {nowhere}, {}); }, message), Fault::internal);
  }
  CloudPoint far;
  far.point.position.x() = 3e6;
  EXPECT_EQ(fault_of([&] { write("cloud.las", {far}, {}); }, message), Fault::output);
  EXPECT_THAT(message, HasSubstr("2147 km"));
  EXPECT_EQ(fault_of([&] { write("cloud.xyz", {}, {}); }, message), Fault::usage);
  EXPECT_THAT(message, HasSubstr(".pcd, .ply or .las"));
  EXPECT_EQ(fault_of([&] { write("absent/cloud.pcd", {}, {}); }, message), Fault::output);
  EXPECT_THAT(message, HasSubstr("create the folder"));
  EXPECT_TRUE(fs::is_empty(path("")));
}

}  // namespace
}  // namespace kissmap
