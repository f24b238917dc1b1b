// SPDX-License-Identifier: MIT
// kissmap export-grid, as a user calls it, on a log that goes round a yard.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "support/file_size_limit.hpp"
#include "support/folder_content.hpp"
#include "support/map_loader_rules.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"
#include "support/yard_log.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

ProgramResult kissmap(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), KISSMAP_BINARY);
  return run_program(arguments);
}

class ExportGrid : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_ = new TempDir;
    write_yard_log(shared_->path() / "log", 40);
    const ProgramResult result = kissmap({"run",
                                          "--no-products",
                                          shared_->path() / "log",
                                          "-o",
                                          shared_->path() / "session",
                                          "--quiet"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  static void TearDownTestSuite() {
    delete shared_;
    shared_ = nullptr;
  }

  static fs::path log() { return shared_->path() / "log"; }
  static fs::path session() { return shared_->path() / "session"; }
  fs::path out(const std::string& name) const { return folder_.path() / name; }
  ProgramResult export_grid(std::vector<std::string> more) const {
    more.insert(more.begin(), {"export-grid", session()});
    return kissmap(more);
  }
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder_.path())) {
      found.push_back(entry.path().filename());
    }
    return found;
  }

  TempDir folder_;
  inline static TempDir* shared_ = nullptr;
};

TEST_F(ExportGrid, WritesAMapAndItsPicture) {
  const ProgramResult result = export_grid({"-o", out("yard")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("yard.yaml"), HasSubstr("m2 free")));
  EXPECT_THAT(names(), UnorderedElementsAre("yard.pgm", "yard.yaml", "yard_look.png"));
  EXPECT_THAT(file_text(out("yard.yaml")),
              AllOf(HasSubstr("image: \"yard.pgm\""), HasSubstr("0.1 m to 1.8 m above the floor")));
}

TEST_F(ExportGrid, IsTheSameForAnyNumberOfThreadsAndUnderAnyOfItsNames) {
  ASSERT_EQ(export_grid({"-o", out("a"), "--resolution", "0.2", "--threads", "1"}).exit_code, 0);
  const auto first = content_of(folder_.path());
  for (const char* threads : {"2", "5"}) {
    ASSERT_EQ(export_grid(
                  {"-o", out("a.yaml"), "--resolution", "0.2", "--threads", threads, "--overwrite"})
                  .exit_code,
              0);
    EXPECT_THAT(differing(first, content_of(folder_.path())), IsEmpty());
  }
}

TEST_F(ExportGrid, BandsAndModesAreThoseAskedFor) {
  ASSERT_EQ(export_grid({"-o", out("loc"), "--for", "localization"}).exit_code, 0);
  EXPECT_THAT(file_text(out("loc.yaml")), HasSubstr("0.1 m to 0.2 m above the floor"));
  ASSERT_EQ(export_grid({"-o",
                         out("own"),
                         "--for",
                         "localization",
                         "--z-max",
                         "0.5",
                         "--z-reference",
                         "map",
                         "--mode",
                         "scale",
                         "--resolution",
                         "0.25",
                         "--crop",
                         "-5,-4,6,3"})
                .exit_code,
            0);
  EXPECT_THAT(file_text(out("own.yaml")),
              AllOf(HasSubstr("0.1 m to 0.5 m above the level"),
                    HasSubstr("mode: scale"),
                    HasSubstr("resolution: 0.25"),
                    HasSubstr("origin: [-5, -4, 0.0]"),
                    HasSubstr("image: \"own.png\"")));
}

TEST_F(ExportGrid, ReplacesNothingUnasked) {
  std::ofstream(out("a.pgm")) << "mine";
  const ProgramResult refused = export_grid({"-o", out("a")});
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("a.pgm"), HasSubstr("--overwrite")));
  EXPECT_EQ(file_text(out("a.pgm")), "mine");
  EXPECT_THAT(names(), UnorderedElementsAre("a.pgm"));
}

TEST_F(ExportGrid, WritesNothingIntoTheSessionOrTheLog) {
  const auto session_before = content_of(session());
  const auto log_before = content_of(log());
  for (const fs::path& place :
       {session() / "map", session() / "products" / ".." / "map", log() / "map"}) {
    for (const char* mode : {"trinary", "scale"}) {
      const ProgramResult result = export_grid({"-o", place, "--mode", mode, "--overwrite"});
      EXPECT_NE(result.exit_code, 0) << place;
      EXPECT_THAT(result.err, HasSubstr(place.parent_path().filename().string()));
    }
  }
  EXPECT_EQ(export_grid({"-o", session() / "map", "--overwrite"}).exit_code, 2);
  EXPECT_EQ(export_grid({"-o", log() / "map", "--overwrite"}).exit_code, 2);
  EXPECT_THAT(differing(session_before, content_of(session())), IsEmpty());
  EXPECT_THAT(differing(log_before, content_of(log())), IsEmpty());
}

TEST_F(ExportGrid, ReplacesFilesOnlyAndWritesBesideNoDevice) {
  const ProgramResult device = export_grid({"-o", "/dev/full"});
  EXPECT_EQ(device.exit_code, 4);
  EXPECT_THAT(device.err, HasSubstr("/dev/full"));
  EXPECT_FALSE(fs::exists("/dev/full.pgm"));
  fs::create_directory(out("a.yaml"));
  EXPECT_EQ(export_grid({"-o", out("a"), "--overwrite"}).exit_code, 4);
  std::ofstream(out("elsewhere")) << "mine";
  fs::create_symlink(out("elsewhere"), out("b_look.png"));
  EXPECT_EQ(export_grid({"-o", out("b"), "--overwrite"}).exit_code, 4);
  EXPECT_EQ(file_text(out("elsewhere")), "mine");
  EXPECT_THAT(names(), UnorderedElementsAre("a.yaml", "elsewhere", "b_look.png"));
}

TEST_F(ExportGrid, AFullDiskLeavesTheOldMapAndNothingElse) {
  ASSERT_EQ(export_grid({"-o", out("a"), "--resolution", "0.5"}).exit_code, 0);
  const auto before = content_of(folder_.path());
  for (const rlim_t bytes : {100, 5'000, 20'000}) {
    const FileSizeLimit limit(bytes);
    const ProgramResult full =
        export_grid({"-o", out("a"), "--resolution", "0.25", "--overwrite", "--quiet"});
    EXPECT_EQ(full.exit_code, 4) << bytes;
    EXPECT_EQ(export_grid({"-o", out("b"), "--resolution", "0.25", "--quiet"}).exit_code, 4);
    EXPECT_THAT(differing(before, content_of(folder_.path())), IsEmpty()) << bytes;
  }
}

TEST_F(ExportGrid, CropsThatHoldNothingOrTooMuchAreRefused) {
  for (const char* crop : {"500,500,510,510",
                           "-1e12,-1e12,1e12,1e12",
                           "-inf,-inf,inf,inf",
                           "0,0,nan,1",
                           "-100000,-100000,100000,100000"}) {
    const ProgramResult result =
        export_grid({"-o", out("a"), "--resolution", "0.2", std::string("--crop=") + crop});
    EXPECT_EQ(result.exit_code, 2) << crop << result.err;
    EXPECT_THAT(result.err, HasSubstr("crop")) << crop;
  }
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(ExportGrid, CellsHaveToFitIntoMemory) {
  // 28 bytes for each of some 90 x 90 / 0.1^2 cells.
  const ProgramResult fine =
      export_grid({"-o", out("a"), "--resolution", "0.1", "--max-memory", "0.01"});
  EXPECT_EQ(fine.exit_code, 2);
  EXPECT_THAT(fine.err,
              AllOf(HasSubstr("--max-memory"), HasSubstr("--resolution"), HasSubstr("--crop")));
  EXPECT_THAT(names(), IsEmpty());
  ASSERT_EQ(export_grid({"-o",
                         out("a"),
                         "--resolution",
                         "0.1",
                         "--max-memory",
                         "0.01",
                         "--crop",
                         "-10,-10,10,10"})
                .exit_code,
            0);
  // Of cells that nobody asked for larger ones are taken.
  ASSERT_EQ(export_grid({"-o", out("b"), "--max-memory", "0.004"}).exit_code, 0);
  EXPECT_THAT(file_text(out("b.yaml")), HasSubstr("resolution: 0.4\n"));
}

TEST_F(ExportGrid, ACropIsWhatTheWholeMapShowsThere) {
  ASSERT_EQ(export_grid({"-o", out("all"), "--resolution", "0.2"}).exit_code, 0);
  ASSERT_EQ(
      export_grid({"-o", out("part"), "--resolution", "0.2", "--crop", "-9,-7,12,8"}).exit_code, 0);
  const LoadedMap all = load_map(out("all.yaml"), MapLoader::nav2);
  const LoadedMap part = load_map(out("part.yaml"), MapLoader::nav2);
  ASSERT_EQ(part.width, 105);
  ASSERT_EQ(part.height, 75);
  const int right = static_cast<int>(std::lround((part.origin[0] - all.origin[0]) / 0.2));
  const int up = static_cast<int>(std::lround((part.origin[1] - all.origin[1]) / 0.2));
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x) {
      ASSERT_EQ(part.data[static_cast<std::size_t>(y * part.width + x)],
                all.data[static_cast<std::size_t>((y + up) * all.width + x + right)])
          << x << " " << y;
    }
  }
}

TEST_F(ExportGrid, MistakesHaveTheirExitCodeAndLeaveNothing) {
  const std::string name = out("a");
  EXPECT_EQ(export_grid({"-o", name, "--z-min", "2", "--z-max", "1"}).exit_code, 2);
  EXPECT_EQ(export_grid({"-o", name, "--resolution", "0.0001"}).exit_code, 2);
  EXPECT_EQ(export_grid({"-o", name, "--resolution", "-1"}).exit_code, 2);
  EXPECT_EQ(export_grid({"-o", name, "--for", "dancing"}).exit_code, 2);
  EXPECT_EQ(export_grid({"-o", name, "--threshold", "2"}).exit_code, 2);
  EXPECT_EQ(export_grid({"-o", name, "--crop", "1,2,3"}).exit_code, 2);
  EXPECT_EQ(export_grid({"-o", name, "--crop", "5,0,1,1"}).exit_code, 2);
  EXPECT_EQ(export_grid({"-o", out("missing/a")}).exit_code, 4);
  EXPECT_EQ(kissmap({"export-grid", out("nothing"), "-o", name}).exit_code, 3);
  const ProgramResult moved = export_grid({"-o", name, "--log", out("elsewhere")});
  EXPECT_EQ(moved.exit_code, 3);
  EXPECT_THAT(moved.err, HasSubstr("--log"));
  EXPECT_THAT(names(), IsEmpty());
}

}  // namespace
}  // namespace kissmap
