// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include "formats/session/pack_frame.hpp"
#include "formats/session/pack_log.hpp"
#include "formats/session/pack_scan.hpp"
#include "kissmap/formats/pack.hpp"
#include "session/example_scans.hpp"
#include "session/example_session.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class DamagedPackFile : public testing::Test {
 protected:
  DamagedPackFile() {
    PackWriter writer(path_);
    for (std::uint32_t i = 0; i < 3; ++i) writer.add(entry_of(i, example_scan(i, 60)));
    writer.add({3, "bad", RefusedScan{"reason", "detail"}});
    writer.finish();
    bytes_ = read_file(path_);
  }

  struct Reading {
    std::string error;
    int scans = 0;
    int refused = 0;  // when packed
    int damaged = 0;
  };
  Reading read(const std::string& bytes) const {
    write_file(path_, bytes);
    Reading reading;
    reading.error = error_of([&] {
      const auto log = open_packed(path_, {});
      while (const auto entry = log->next()) {
        if (const auto* refusal = std::get_if<RefusedScan>(&entry->content)) {
          ++(refusal->reason == "damaged in the pack" ? reading.damaged : reading.refused);
        } else {
          require_consistent(std::get<Scan>(entry->content));
          ++reading.scans;
        }
      }
    });
    return reading;
  }

  TempDir folder_;
  std::filesystem::path path_ = folder_.path() / "log.kmpack";
  std::string bytes_;
};

TEST_F(DamagedPackFile, EveryCutIsRefusedAtOnce) {
  for (std::size_t size = 0; size < bytes_.size(); ++size) {
    const Reading reading = read(bytes_.substr(0, size));
    ASSERT_THAT(reading.error,
                AllOf(StartsWith("input: " + path_.string()),
                      HasSubstr("cut off"),
                      HasSubstr("kissmap pack")));
    ASSERT_EQ(reading.scans, 0);
  }
}

TEST_F(DamagedPackFile, EveryFlippedByteIsNoticed) {
  std::mt19937 random(11);
  for (std::size_t at = 0; at < bytes_.size(); ++at) {
    std::string damaged = bytes_;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 + random() % 255));
    const Reading reading = read(damaged);
    const bool noticed = reading.error != "no error" || reading.damaged == 1;
    ASSERT_TRUE(noticed) << "byte " << at;
    ASSERT_THAT(reading.error, testing::AnyOf(StartsWith("input: "), "no error"));
  }
}

TEST_F(DamagedPackFile, OneDamagedScanLeavesTheOthers) {
  std::string damaged = bytes_;
  damaged[pack_header_size + frame_header_size + 20] ^= 1;
  const Reading reading = read(damaged);
  EXPECT_EQ(reading.error, "no error");
  EXPECT_EQ(reading.scans, 2);
  EXPECT_EQ(reading.refused, 1);
  EXPECT_EQ(reading.damaged, 1);
}

TEST_F(DamagedPackFile, NewerVersionsNameTheCure) {
  ByteWriter header;
  for (const char character : std::string("KMPACK\r\n")) header.value(character);
  header.value(std::uint32_t{2});
  std::string bytes = bytes_;
  bytes.replace(0, header.bytes().size(), header.bytes());
  EXPECT_THAT(read(bytes).error, HasSubstr("damaged file header"));
}

TEST_F(DamagedPackFile, MissingScansAreNoticed) {
  const std::size_t first = pack_header_size;
  const FrameHeader header = parse_frame_header(bytes_.substr(first, frame_header_size));
  std::string shorter = bytes_;
  shorter.erase(first, frame_header_size + header.stored_size);
  EXPECT_THAT(read(shorter).error, HasSubstr("missing"));
}

TEST_F(DamagedPackFile, BytesAfterTheEndAreNoticed) {
  const std::string end = bytes_.substr(bytes_.size() - frame_header_size);
  EXPECT_THAT(read(bytes_ + "x").error, StartsWith("input: "));
  EXPECT_THAT(read(bytes_ + end).error, HasSubstr("goes on after its end"));
}

TEST_F(DamagedPackFile, ImpossibleSizesAreRefusedBeforeMemoryIsAskedFor) {
  FrameHeader header{FrameKind::scan, 0, max_unpacked_size, 100, 0};
  EXPECT_THROW(parse_frame_header(frame_header(header)), DamagedPack);
  header = {FrameKind::scan, 0, max_unpacked_size + 1, 0xFFFFFFFF, 0};
  EXPECT_THROW(parse_frame_header(frame_header(header)), DamagedPack);
  header = {FrameKind::scan, 0, 100, 0x7FFFFFFF, 0};
  const std::string pack =
      pack_header() + frame_header(header) + frame_header({FrameKind::end, 1, 0, 0, 0});
  EXPECT_THAT(read(pack).error, HasSubstr("ends after the file"));
}

TEST_F(DamagedPackFile, UnfinishedPackIsRefusedWithTheCure) {
  {
    PackWriter writer(path_);
    writer.add(entry_of(0, example_scan(1)));
  }
  EXPECT_THAT(error_of([&] { open_packed(path_, {}); }), HasSubstr("kissmap pack"));
}

// Checksums keep accidents out of here; these are what a forged pack would reach.
TEST(DamagedPackedScan, EveryCutAndFlipIsADamagedPackOrAConsistentScan) {
  const std::string bytes = encode_scan("name", example_scan(5, 40));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(decode_scan(bytes.substr(0, size)), DamagedPack) << size;
  }
  std::mt19937 random(12);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 + random() % 255));
    try {
      require_consistent(std::get<Scan>(decode_scan(damaged).content));
    } catch (const DamagedPack&) {  // anything else ends the test
    }
  }
}

TEST(DamagedPackedScan, RefusalsAreReadExactly) {
  const std::string bytes = encode_refusal("name", {"reason", "detail"});
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(decode_refusal(bytes.substr(0, size)), DamagedPack) << size;
  }
  EXPECT_THROW(decode_refusal(bytes + "x"), DamagedPack);
}

}  // namespace
}  // namespace kissmap
