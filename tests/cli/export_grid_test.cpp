// SPDX-License-Identifier: MIT
// kissmap export-grid, as a user calls it, on a log that goes round a yard.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "support/folder_content.hpp"
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
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("a.pgm"), HasSubstr("--overwrite")));
  EXPECT_EQ(file_text(out("a.pgm")), "mine");
  EXPECT_THAT(names(), UnorderedElementsAre("a.pgm"));
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
