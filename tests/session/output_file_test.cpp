// SPDX-License-Identifier: MIT
#include "formats/files/output_file.hpp"

#include <gmock/gmock.h>

#include "formats/files/xxh3.hpp"
#include "kissmap/formats/pack.hpp"
#include "kissmap/formats/pictures.hpp"
#include "session/example_session.hpp"
#include "support/file_size_limit.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TEST(OutputFile, FullDeviceIsAnOutputErrorWithACure) {
  OutputFile file("/dev/full");
  file.write("x");
  EXPECT_THAT(
      error_of([&] { file.flush(); }),
      AllOf(StartsWith("output: /dev/full"), HasSubstr("No space"), HasSubstr("free some")));
}

TEST(OutputFile, LargeWritesFailAtOnceNotAtTheEnd) {
  OutputFile file("/dev/full");
  EXPECT_THAT(error_of([&] { file.write(std::string(1 << 20, 'x')); }), StartsWith("output: "));
}

TEST(OutputFile, MissingFolderIsNamed) {
  const TempDir folder;
  const auto path = folder.path() / "missing" / "file";
  EXPECT_THAT(error_of([&] { OutputFile file(path); }),
              AllOf(StartsWith("output: " + path.string()), HasSubstr("create the folder")));
}

TEST(OutputFile, NothingAppearsUnderTheNameBeforeAllIsWritten) {
  const TempDir folder;
  const auto path = folder.path() / "file";
  write_whole_file(path, "first");
  const FileSizeLimit limit(3);
  EXPECT_THAT(error_of([&] { write_whole_file(path, "second"); }), StartsWith("output: "));
  EXPECT_EQ(read_file(path), "first");
  EXPECT_FALSE(std::filesystem::exists(aside(path))) << "half a file is of no use";
}

TEST(OutputFile, OfSeveralFilesNoneAppearsUnlessAllAreWritten) {
  const TempDir folder;
  const auto old = folder.path() / "old";
  const auto fresh = folder.path() / "new";
  write_whole_file(old, "first");
  {
    const FileSizeLimit limit(7);
    EXPECT_THAT(error_of([&] {
                  write_whole_files({{old, "second"}, {fresh, "too long"}});
                }),
                StartsWith("output: " + fresh.string()));
  }
  EXPECT_EQ(read_file(old), "first");
  EXPECT_FALSE(std::filesystem::exists(fresh));
  EXPECT_FALSE(std::filesystem::exists(aside(old)));
  EXPECT_FALSE(std::filesystem::exists(aside(fresh)));
  write_whole_files({{old, "second"}, {fresh, "too long"}});
  EXPECT_EQ(read_file(old), "second");
  EXPECT_EQ(read_file(fresh), "too long");
}

TEST(OutputFile, PackOnAFullDeviceFails) {
  PackWriter pack("/dev/full");
  EXPECT_THAT(error_of([&] { pack.finish(); }), StartsWith("output: /dev/full"));
}

TEST(OutputFile, SessionOnAFullDiskFailsAndKeepsTheOldOne) {
  const TempDir folder;
  const auto path = folder.path() / "session";
  write_session(example_session(), example_surfels(), path);
  const std::string manifest = read_file(path / "session.json");
  int failures = 0;
  for (rlim_t limit = 0; limit < 6000; limit += 61) {
    const FileSizeLimit full(limit);
    const std::string error =
        error_of([&] { write_session(example_session(), example_surfels(), path, true); });
    if (error == "no error") break;
    ASSERT_THAT(error, AllOf(StartsWith("output: " + path.string()), HasSubstr("free some")));
    ++failures;
  }
  EXPECT_GT(failures, 50);
  EXPECT_EQ(read_file(path / "session.json"), manifest);
  EXPECT_EQ(read_session(path).scans.size(), example_session().scans.size());
}

TEST(OutputFile, PictureOnAFullDiskLeavesNone) {
  const TempDir folder;
  const Picture picture{100, 100, std::vector<std::uint8_t>(30000, 7)};
  const FileSizeLimit full(10);
  EXPECT_THAT(error_of([&] { write_png(picture, folder.path() / "map.png"); }),
              StartsWith("output: "));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "map.png"));
}

TEST(Xxh3, MatchesThePublishedTestVectors) {
  // XXH3-64 and XXH3-128 of nothing, seed 0 (xxHash's own sanity test).
  EXPECT_EQ(xxh3_64({}), 0x2D06800538D394C2U);
  EXPECT_EQ(xxh3_hex(""), "99aa06d3014798d86001c324468d497f");
}

TEST(Xxh3, PiecesHashLikeTheWhole) {
  const std::string text(100'000, 'k');
  Xxh3Stream stream;
  for (std::size_t at = 0; at < text.size(); at += 777) stream.add(text.substr(at, 777));
  EXPECT_EQ(stream.hex(), xxh3_hex(text));
}

}  // namespace
}  // namespace kissmap
