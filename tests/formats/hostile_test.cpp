// SPDX-License-Identifier: MIT
// Damaged files, made systematically: each must end in an Error, a RefusedScan or a consistent
// scan, without allocating more than a multiple of its size.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "formats/allocation_meter.hpp"
#include "formats/files/input_file.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::Bytes;
using test::TempDir;

std::string pcd(const std::string& data, const std::string& payload) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z t\nSIZE 4 4 4 4\n"
         "TYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 5\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS "
         "5\nDATA " +
         data + "\n" + payload;
}

std::string points(std::endian order) {
  Bytes bytes(order);
  for (int i = 1; i <= 5; ++i) {
    bytes.add<float>(static_cast<float>(i))
        .add<float>(2)
        .add<float>(3)
        .add<std::uint32_t>(static_cast<std::uint32_t>(i) * 10'000'000U);
  }
  return bytes.text();
}

std::string compressed_points() {
  const std::string raw = points(std::endian::little);  // planes of odd content do as well
  std::string packed;
  for (std::size_t i = 0; i < raw.size(); i += 32) {
    const std::string run = raw.substr(i, 32);
    packed += static_cast<char>(run.size() - 1) + run;
  }
  return Bytes()
             .add<std::uint32_t>(static_cast<std::uint32_t>(packed.size()))
             .add<std::uint32_t>(static_cast<std::uint32_t>(raw.size()))
             .text() +
         packed;
}

std::string ply(const std::string& format, const std::string& payload) {
  return "ply\nformat " + format +
         " 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 5\n"
         "property float x\nproperty float y\nproperty float z\nproperty uint t\nend_header\n" +
         payload;
}

const std::string ascii_points =
    "1 2 3 1\n2 2 3 2000000\n3 nan 3 3000000\n4 2 3 4\n5 2 3 50000000\n";

/// Small files of every kind, all of which can be read.
std::map<std::string, std::string> sound_files() {
  const std::string face_little = Bytes().add<std::uint8_t>(1).add<std::int32_t>(0).text();
  return {{"ascii.pcd", pcd("ascii", ascii_points)},
          {"binary.pcd", pcd("binary", points(std::endian::little))},
          {"compressed.pcd", pcd("binary_compressed", compressed_points())},
          {"ascii.ply", ply("ascii", "1 0\n" + ascii_points)},
          {"little.ply", ply("binary_little_endian", face_little + points(std::endian::little))},
          {"big.ply", ply("binary_big_endian", face_little + points(std::endian::big))},
          {"columns.bin", points(std::endian::little).substr(0, 64)}};
}

/// Reads one file as a log and checks the promises; tells how it ended.
std::string ending(const TempDir& dir, const std::string& name, const std::string& content) {
  const fs::path file = dir.write(name, content);
  test::forget_allocations();
  std::string result = "no entry";
  try {
    const auto log = open_log(file);
    while (const auto entry = log->next()) {
      if (const auto* refused = std::get_if<RefusedScan>(&entry->content)) {
        EXPECT_THAT(refused->detail, testing::HasSubstr(name));
        result = refused->reason;
      } else {
        require_consistent(std::get<Scan>(entry->content));
        result = "scan";
      }
    }
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::input) << error.what();
    result = "error";
  }
  EXPECT_LE(test::largest_allocation(), 100 * content.size() + 65'536) << name;
  return result;
}

TEST(Hostile, SoundFilesAreRead) {
  const TempDir dir;
  for (const auto& [name, content] : sound_files()) EXPECT_EQ(ending(dir, name, content), "scan");
}

TEST(Hostile, EveryTruncationIsNoticed) {
  const TempDir dir;
  for (const auto& [name, content] : sound_files()) {
    std::size_t unnoticed = 0;
    for (std::size_t size = 0; size < content.size(); ++size) {
      const std::string end = ending(dir, name, content.substr(0, size));
      if (end == "scan") ++unnoticed;
    }
    // Text can lose its last newline and digits of its last number and still be whole; a .bin may
    // end behind any row, here behind 16, 20, 24, 32, 40 or 60 bytes.
    const std::size_t allowed = name.starts_with("ascii") ? 8 : name == "columns.bin" ? 6 : 0;
    EXPECT_LE(unnoticed, allowed) << name;
  }
}

// Every number of the header, replaced by others.
TEST(Hostile, HeaderNumbersMayBeAnything) {
  const TempDir dir;
  const std::vector<std::string> replacements = {"0",
                                                 "-1",
                                                 "1",
                                                 "2",
                                                 "7",
                                                 "4294967295",
                                                 "4294967296",
                                                 "18446744073709551615",
                                                 "18446744073709551616",
                                                 "999999999999999999999999",
                                                 "1e9",
                                                 "0x10",
                                                 "nan",
                                                 "",
                                                 "x",
                                                 "5 5"};
  for (const auto& [name, content] : sound_files()) {
    if (name.ends_with(".bin")) continue;
    const std::size_t header =
        name.ends_with(".pcd") ? content.find("DATA ") : content.find("end_header");
    for (std::size_t begin = 0; begin < header; ++begin) {
      const auto digit = [&text = content](std::size_t i) {
        return text[i] >= '0' && text[i] <= '9';
      };
      if (!digit(begin) || (begin > 0 && digit(begin - 1))) continue;
      std::size_t end = begin;
      while (digit(end)) ++end;
      for (const std::string& replacement : replacements) {
        SCOPED_TRACE(name + " at " + std::to_string(begin) + ": " + replacement);
        ending(dir, name, content.substr(0, begin) + replacement + content.substr(end));
      }
    }
  }
}

TEST(Hostile, HeaderLinesMayBeMissingDoubledOrSwapped) {
  const TempDir dir;
  for (const auto& [name, content] : sound_files()) {
    if (name.ends_with(".bin")) continue;
    for (std::size_t begin = 0; begin < content.size();) {
      const std::size_t end = std::min(content.find('\n', begin), content.size() - 1) + 1;
      const std::string line = content.substr(begin, end - begin);
      SCOPED_TRACE(name + ": " + line);
      ending(dir, name, content.substr(0, begin) + content.substr(end));
      ending(dir, name, content.substr(0, end) + line + content.substr(end));
      ending(dir, name, line + content.substr(0, begin) + content.substr(end));
      begin = end;
    }
  }
}

TEST(Hostile, BytesMayFlip) {
  const TempDir dir;
  std::mt19937 random(7);
  for (const auto& [name, content] : sound_files()) {
    for (int round = 0; round < 1500; ++round) {
      std::string damaged = content;
      for (unsigned flips = 1 + random() % 4; flips > 0; --flips) {
        damaged[random() % damaged.size()] = static_cast<char>(random());
      }
      SCOPED_TRACE(name + " round " + std::to_string(round));
      ending(dir, name, damaged);
    }
  }
}

TEST(Hostile, NamesAndContentsMayBeConfused) {
  const TempDir dir;
  for (const auto& [name, content] : sound_files()) {
    for (const char* other : {"a.pcd", "b.ply", "c.bin"}) {
      const bool same_kind = fs::path(name).extension() == fs::path(other).extension();
      const std::string end = ending(dir, other, content);
      if (!same_kind && !name.ends_with(".bin")) {
        EXPECT_EQ(end, "not what its name says") << name << " as " << other;
      }
      if (same_kind) {
        EXPECT_EQ(end, "scan");
      }
    }
  }
}

TEST(Hostile, RandomBytesAreNoCloud) {
  const TempDir dir;
  std::mt19937 random(8);
  for (int round = 0; round < 300; ++round) {
    std::string noise(random() % 300, '\0');
    for (char& c : noise) c = static_cast<char>(random());
    for (const char* name : {"n.pcd", "n.ply", "n.bin"}) {
      const std::string end = ending(dir, name, noise);
      if (std::string(name) != "n.bin") {
        EXPECT_NE(end, "scan");
      }
    }
  }
}

TEST(Hostile, AFileTooLargeForAScanIsNotRead) {
  const TempDir dir;
  const fs::path file = dir.write("0.pcd", "VERSION 0.7\n");
  fs::resize_file(file, max_file_bytes + 1);  // sparse: takes no room on disk
  dir.write("1.pcd", pcd("ascii", ascii_points));
  test::forget_allocations();
  const auto log = open_log(dir.path());
  EXPECT_EQ(test::refusal_of(*log->next()).reason, "file too large for one scan");
  EXPECT_LE(test::largest_allocation(), 65'536U);
  EXPECT_EQ(test::scan_of(*log->next()).points.size(), 4U);
}

}  // namespace
}  // namespace kissmap
