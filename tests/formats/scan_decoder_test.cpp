// SPDX-License-Identifier: MIT
#include "formats/clouds/scan_decoder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "formats/clouds/refusal.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

using test::Bytes;
using test::bytes_of;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float inf = std::numeric_limits<float>::infinity();

PointRecords records(const std::string& bytes,
                     std::vector<RecordField> fields,
                     std::size_t stride,
                     std::endian order = std::endian::little) {
  PointRecords result;
  for (RecordField& field : fields) field.stride = stride;
  result.layout = {std::move(fields), order};
  result.count = bytes.size() / stride;
  result.bytes = bytes_of(bytes);
  return result;
}

std::vector<RecordField> xyz_and(ScalarType type, const char* name) {
  return {{"x", ScalarType::f32, 0, 0, 1},
          {"y", ScalarType::f32, 4, 0, 1},
          {"z", ScalarType::f32, 8, 0, 1},
          {name, type, 12, 0, 1}};
}

template <class T>
void expect_coordinates_of_type(ScalarType type, std::endian order) {
  // Fields out of order and unaligned; the coordinates fit every type.
  const std::size_t size = sizeof(T);
  Bytes bytes(order);
  for (int i = 1; i <= 3; ++i) {
    bytes.pad(1);
    for (const int coordinate : {30, 10, 20}) {
      bytes.template add<T>(static_cast<T>(coordinate + i));
    }
  }
  const auto fields = std::vector<RecordField>{
      {"z", type, 1, 0, 1}, {"x", type, 1 + size, 0, 1}, {"y", type, 1 + 2 * size, 0, 1}};
  const Scan scan = ScanDecoder({}).decode(records(bytes.text(), fields, 1 + 3 * size, order), 7);
  require_consistent(scan);
  ASSERT_EQ(scan.points.size(), 3U);
  EXPECT_EQ(scan.points[2], Eigen::Vector3f(13, 23, 33));
  EXPECT_EQ(scan.stamp_ns, 7);
}

TEST(ScanDecoder, ReadsEveryTypeInBothByteOrders) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    expect_coordinates_of_type<std::int8_t>(ScalarType::i8, order);
    expect_coordinates_of_type<std::uint8_t>(ScalarType::u8, order);
    expect_coordinates_of_type<std::int16_t>(ScalarType::i16, order);
    expect_coordinates_of_type<std::uint16_t>(ScalarType::u16, order);
    expect_coordinates_of_type<std::int32_t>(ScalarType::i32, order);
    expect_coordinates_of_type<std::uint32_t>(ScalarType::u32, order);
    expect_coordinates_of_type<std::int64_t>(ScalarType::i64, order);
    expect_coordinates_of_type<std::uint64_t>(ScalarType::u64, order);
    expect_coordinates_of_type<float>(ScalarType::f32, order);
    expect_coordinates_of_type<double>(ScalarType::f64, order);
  }
}

TEST(ScanDecoder, DropsWhatIsNoReturnWithItsTimeAndIntensity) {
  Bytes bytes;
  const auto add = [&](float x, float y, float z, float intensity, float time) {
    bytes.add<float>(x).add<float>(y).add<float>(z).add<float>(intensity).add<float>(time);
  };
  add(nan, 1, 1, 0, 0.00F);
  add(1, 2, 3, 10, 0.01F);
  add(0, 0, 0, 20, 0.02F);
  add(0, inf, 0, 30, 0.03F);
  add(9999, 0, 0, 40, 0.04F);
  add(0, -10001, 0, 50, 0.05F);
  add(4, 5, 6, 60, nan);
  add(1e-30F, 0, 0, 70, 0.07F);
  auto fields = xyz_and(ScalarType::f32, "intensity");
  fields.push_back({"time", ScalarType::f32, 16, 0, 1});
  const Scan scan = ScanDecoder({}).decode(records(bytes.text(), fields, 20), 0);
  require_consistent(scan);
  EXPECT_THAT(scan.intensities, testing::ElementsAre(10, 40, 70));
  EXPECT_THAT(scan.time_offsets, testing::ElementsAre(0.01F, 0.04F, 0.07F));
  EXPECT_EQ(scan.points[1].x(), 9999.0F);
  EXPECT_EQ(scan.dropped, (DroppedReturns{3, 1, 1}));
  EXPECT_EQ(scan.time_source, TimeSource::recorded);
}

TEST(ScanDecoder, KeepsPointsWhenAllTimesAreNan) {
  Bytes bytes;
  for (int i = 1; i <= 3; ++i) {
    bytes.add<float>(static_cast<float>(i)).add<float>(0).add<float>(0).add<float>(nan);
  }
  const Scan scan =
      ScanDecoder({}).decode(records(bytes.text(), xyz_and(ScalarType::f32, "t"), 16), 0);
  require_consistent(scan);
  EXPECT_EQ(scan.points.size(), 3U);
  EXPECT_EQ(scan.time_source, TimeSource::none);
}

TEST(ScanDecoder, GivesAnEmptyScanWhenNothingIsAReturn) {
  Bytes bytes;
  for (int i = 0; i < 12; ++i) bytes.add<float>(nan);
  const Scan scan =
      ScanDecoder({}).decode(records(bytes.text(), xyz_and(ScalarType::f32, "time"), 16), 0);
  require_consistent(scan);
  EXPECT_EQ(scan.points.size(), 0U);
  EXPECT_EQ(scan.dropped.non_finite, 3U);
}

TEST(ScanDecoder, CountsDoublesBeyondFloatAsImplausible) {
  Bytes bytes;
  bytes.add<double>(1e200).add<double>(0).add<double>(0);
  bytes.add<double>(-std::numeric_limits<double>::infinity()).add<double>(0).add<double>(0);
  const Scan scan = ScanDecoder({}).decode(records(bytes.text(),
                                                   {{"x", ScalarType::f64, 0, 0, 1},
                                                    {"y", ScalarType::f64, 8, 0, 1},
                                                    {"z", ScalarType::f64, 16, 0, 1}},
                                                   24),
                                           0);
  EXPECT_EQ(scan.dropped, (DroppedReturns{1, 0, 1}));
}

TEST(ScanDecoder, ReadsMoreThanOneBlockLikeOneByOne) {
  Bytes bytes;
  constexpr int count = 2000;
  for (int i = 0; i < count; ++i) {
    const auto value = static_cast<float>(i % 7 == 0 ? 0 : i);
    bytes.add<float>(value).add<float>(value).add<float>(-value).add<std::uint32_t>(
        static_cast<std::uint32_t>(i) * 50'000U);
  }
  const Scan scan =
      ScanDecoder({}).decode(records(bytes.text(), xyz_and(ScalarType::u32, "t"), 16), 0);
  require_consistent(scan);
  std::size_t kept = 0;
  for (int i = 0; i < count; ++i) {
    if (i % 7 == 0) continue;
    ASSERT_EQ(scan.points[kept].x(), static_cast<float>(i));
    ASSERT_NEAR(scan.time_offsets[kept], i * 5e-5, 1e-8);
    ++kept;
  }
  EXPECT_EQ(scan.points.size(), kept);
  EXPECT_EQ(scan.dropped.zero, count - kept);
}

TEST(ScanDecoder, PrefersTimeFieldsInTheOrderOfTheRule) {
  Bytes bytes;
  for (int i = 1; i <= 2; ++i) {
    bytes.add<float>(1).add<float>(1).add<float>(1).add<float>(0.5F * static_cast<float>(i));
    bytes.add<std::uint32_t>(static_cast<std::uint32_t>(i) * 1000U);
    bytes.add<std::uint8_t>(3);
  }
  auto fields = xyz_and(ScalarType::f32, "timestamp");
  fields.push_back({"offset_time", ScalarType::u32, 16, 0, 1});
  fields.push_back({"t", ScalarType::u8, 20, 0, 1});  // too narrow for a time
  const auto decode = [&](const ReadOptions& options) {
    return ScanDecoder(options).decode(records(bytes.text(), fields, 21), 0).time_offsets;
  };
  EXPECT_THAT(decode({}), testing::ElementsAre(0.5F, 1.0F));
  ReadOptions other_field;
  other_field.time_field = "offset_time";
  EXPECT_THAT(decode(other_field), testing::ElementsAre(1e-6F, 2e-6F));
  ReadOptions no_times;
  no_times.time_unit = "none";
  EXPECT_THAT(decode(no_times), testing::IsEmpty());
}

TEST(ScanDecoder, KeepsTheUnitOfTheFirstFullScan) {
  // A sliver of a sweep spans 1.5 ms: alone it would pass for seconds.
  const auto scan_bytes = [](int count, float span_ms) {
    Bytes bytes;
    for (int i = 0; i < count; ++i) {
      bytes.add<float>(1).add<float>(1).add<float>(1).add<float>(span_ms * static_cast<float>(i) /
                                                                 static_cast<float>(count - 1));
    }
    return bytes.text();
  };
  ScanDecoder decoder({});
  const auto decode = [&](const std::string& bytes) {
    return decoder.decode(records(bytes, xyz_and(ScalarType::f32, "time"), 16), 0).time_offsets;
  };
  EXPECT_NEAR(decode(scan_bytes(200, 99.0F)).back(), 0.099, 1e-6);
  EXPECT_NEAR(decode(scan_bytes(3, 1.5F)).back(), 0.0015, 1e-8);
}

TEST(ScanDecoder, NamesTheFieldsItLacks) {
  const std::string bytes(64, '\0');
  auto fields = xyz_and(ScalarType::f32, "time");
  fields[1].name = "why";
  try {
    ScanDecoder({}).decode(records(bytes, fields, 16), 0);
    FAIL();
  } catch (const Refusal& refusal) {
    EXPECT_STREQ(refusal.reason(), refusal_reason::no_coordinates);
    EXPECT_THAT(refusal.what(), testing::HasSubstr("x why z time"));
  }
  ReadOptions options;
  options.time_field = "stamp";
  EXPECT_THROW(ScanDecoder(options).decode(records(bytes, xyz_and(ScalarType::f32, "time"), 16), 0),
               Refusal);
}

TEST(ScanDecoder, RefusesFieldsOutsideOfTheBytes) {
  const std::string bytes(64, '\1');
  PointRecords reaching = records(bytes, xyz_and(ScalarType::f64, "intensity"), 16);
  EXPECT_THROW(ScanDecoder({}).decode(reaching, 0), Refusal);
  PointRecords too_many = records(bytes, xyz_and(ScalarType::f32, "intensity"), 16);
  too_many.count = static_cast<std::size_t>(-1);
  EXPECT_THROW(ScanDecoder({}).decode(too_many, 0), Refusal);
  PointRecords no_stride = records(bytes, xyz_and(ScalarType::f32, "intensity"), 16);
  for (RecordField& field : no_stride.layout.fields) field.stride = 0;
  EXPECT_THROW(ScanDecoder({}).decode(no_stride, 0), Refusal);
  PointRecords wrapping = records(bytes, xyz_and(ScalarType::f32, "intensity"), 16);
  wrapping.layout.fields[0].offset = static_cast<std::size_t>(-2);
  EXPECT_THROW(ScanDecoder({}).decode(wrapping, 0), Refusal);
}

TEST(ScanDecoder, FindsFieldsUnderTheirOtherNames) {
  Bytes bytes;
  bytes.add<float>(1).add<float>(2).add<float>(3).add<float>(4);
  for (const char* name : {"i", "Intensity", "scalar_Intensity", "reflectance", "remission"}) {
    const Scan scan =
        ScanDecoder({}).decode(records(bytes.text(), xyz_and(ScalarType::f32, name), 16), 0);
    EXPECT_THAT(scan.intensities, testing::ElementsAre(4)) << name;
  }
}

}  // namespace
}  // namespace kissmap
