// SPDX-License-Identifier: MIT
// Bytes that specifications fix, where a reader of ours alone would not notice another choice.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/containers/unpack.hpp"
#include "formats/message_bytes.hpp"
#include "formats/support.hpp"
#include "formats/voxels/voxel_writer.hpp"
#include "kissmap/formats/cloud_writer.hpp"
#include "kissmap/formats/scan_writer.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::hex;
using test::little;
using test::TempDir;
using testing::ElementsAre;

std::string content_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <class T>
T number_at(const std::string& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.substr(offset, sizeof(T)).data(), sizeof(T));
  return value;
}

/// What an MCAP file says of one chunk.
struct ChunkWithIndex {
  std::string records;  ///< unpacked
  std::string entries;  ///< of its message index: a time and an offset for each message
};

// mcap.dev/spec: each record is an opcode, 64 bits of length, and its content.
std::vector<ChunkWithIndex> chunks_of(const std::string& file) {
  constexpr char chunk = 6;
  constexpr char message_index = 7;
  constexpr char data_end = 15;
  std::vector<ChunkWithIndex> chunks;
  for (std::size_t at = 8; file.at(at) != data_end;) {
    const auto size = number_at<std::uint64_t>(file, at + 1);
    const std::string content = file.substr(at + 9, size);
    if (file[at] == chunk) {
      EXPECT_EQ(content.substr(28, 8), little<std::uint32_t>(4) + "zstd");
      const std::string packed = content.substr(44);
      std::vector<std::byte> bytes;
      unpack(compression_named("zstd"),
             test::bytes_of(packed),
             number_at<std::uint64_t>(content, 16),
             bytes);
      chunks.push_back({{reinterpret_cast<const char*>(bytes.data()), bytes.size()}, ""});
    }
    if (file[at] == message_index) chunks.back().entries += content.substr(6);
    at += 9 + size;
  }
  return chunks;
}

TEST(McapMessageIndex, CountsOffsetsFromTheStartOfTheUnpackedChunk) {
  constexpr int scans = 40;
  constexpr std::int64_t first_ns = 1'700'000'000'000'000'000;
  const TempDir dir;
  const fs::path path = dir.path() / "log.mcap";
  const auto writer = open_scan_writer(path, ScanFormat::mcap);
  for (int k = 0; k < scans; ++k) {
    Scan scan;
    scan.stamp_ns = first_ns + k;
    scan.points.assign(20'000, Eigen::Vector3f(static_cast<float>(k), 2, 3));
    writer->add(scan);
  }
  writer->finish();
  std::int64_t next_ns = first_ns;
  const auto chunks = chunks_of(content_of(path));
  ASSERT_GE(chunks.size(), 2U);
  for (const ChunkWithIndex& chunk : chunks) {
    for (std::size_t at = 0; at < chunk.entries.size(); at += 16) {
      const auto offset = number_at<std::uint64_t>(chunk.entries, at + 8);
      // Opcode and length of a message, its channel and number, then when it was recorded.
      EXPECT_EQ(chunk.records.at(offset), '\5');
      EXPECT_EQ(number_at<std::int64_t>(chunk.records, offset + 15), next_ns);
      EXPECT_EQ(number_at<std::int64_t>(chunk.entries, at), next_ns++);
    }
  }
  EXPECT_EQ(next_ns, first_ns + scans);
  // The first chunk begins with a schema, so its first message does not.
  EXPECT_EQ(chunks[0].records[0], '\3');
  EXPECT_GT(number_at<std::uint64_t>(chunks[0].entries, 8), 0U);
}

// Bits 0 to 2: number of the return, 3 to 5: how many there were. 1 of 1.
TEST(LasFlags, AreOneOfOneInThreeBitsEach) {
  const TempDir dir;
  for (int format = 0; format < 4; ++format) {
    CloudWriterOptions options;
    options.fields.time = (format & 1) != 0;
    options.fields.rgb = (format & 2) != 0;
    const fs::path path = dir.path() / "cloud.las";
    const auto writer = open_cloud_writer(path, options);
    for (int k = 0; k < 3; ++k) {
      CloudPoint point;
      point.point.position = Eigen::Vector3d(k, 2, 3);
      writer->add(point);
    }
    writer->finish();
    const std::string file = content_of(path);
    constexpr std::size_t header = 227;
    const auto record = number_at<std::uint16_t>(file, 105);
    EXPECT_EQ(file[104], format);
    ASSERT_EQ(file.size(), header + 3U * record);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(file[header + k * record + 14], '\x09');
  }
}

// In formats 6 to 10 four bits each, and all that follows lies elsewhere than before. Only the 64
// bits of LAS 1.4 count the points.
TEST(LasFlags, OfFourBitsEachLeaveTimesWhereTheyAre) {
  std::string file(375, '\0');
  const auto put = [&file](std::size_t at, const std::string& bytes) {
    file.replace(at, bytes.size(), bytes);
  };
  put(0, "LASF");
  put(24, hex("01 04"));
  put(94, little<std::uint16_t>(375) + little<std::uint32_t>(375));
  put(104, hex("06") + little<std::uint16_t>(30));
  for (const std::size_t axis : {0U, 1U, 2U}) put(131 + 8 * axis, little<double>(0.25));
  put(155, little<double>(100.0));
  put(247, little<std::uint64_t>(2));
  for (const int k : {0, 1}) {
    file += little<std::int32_t>(-4 + k) + little<std::int32_t>(8) + little<std::int32_t>(-12);
    file += little<std::uint16_t>(static_cast<std::uint16_t>(500 + k)) + hex("11 00 02 00");
    file += little<std::int16_t>(-3000) + little<std::uint16_t>(7);
    file += little<double>(345'600.5 + 0.25 * k);
  }
  ReadOptions options;
  options.time_field = "gps_time";
  const TempDir dir;
  const auto entry = open_log(dir.write("cloud.las", file), options)->next();
  ASSERT_TRUE(entry.has_value());
  const Scan& scan = test::scan_of(*entry);
  EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3f(99, 2, -3), Eigen::Vector3f(99.25F, 2, -3)));
  EXPECT_THAT(scan.intensities, ElementsAre(500, 501));
  EXPECT_THAT(scan.time_offsets, ElementsAre(0.0F, 0.25F));
}

// (1.05, 0.05, 0.05) in voxels of 0.1 m has the key (32778, 32768, 32768), whose bits, the highest
// first, are 1000000000001010, 1000000000000000, 1000000000000000: of the 16 levels the first goes
// to child 7, two to child 1 and all others to child 0.
TEST(OctoMapKey, IsThePathDownTheTree) {
  OccupancyMap map({{0.0, 0.0, 0.0}, {0.1, 0.1, 0.1}, std::nullopt});
  ThreadPool pool(1);
  const std::vector<Eigen::Vector3f> start{{1.02F, 0.05F, 0.05F}};
  const std::vector<Eigen::Vector3f> end{{1.05F, 0.05F, 0.05F}};
  RayScan ray;
  ray.starts = start;
  ray.ends = end;
  EXPECT_EQ(map.add(ray, pool).hit_voxels, 1U);
  VoxelWriterOptions options;
  options.geometry = map.geometry();
  const TempDir dir;
  const fs::path path = dir.path() / "point.bt";
  const auto writer = open_voxel_writer(path, options);
  writer->add(map);
  writer->finish();
  const std::string file = content_of(path);
  // Two bits a child, child 0 the lowest: 3 for one with children, 2 for one that is occupied.
  std::string expected = hex("00 C0");
  for (int level = 0; level < 11; ++level) expected += hex("03 00");
  expected += hex("0C 00 03 00 0C 00 02 00");
  EXPECT_EQ(file.substr(file.find("\ndata\n") + 6), expected);
}

}  // namespace
}  // namespace kissmap
