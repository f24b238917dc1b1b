// SPDX-License-Identifier: MIT
// The real binary, as a user calls it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "support/folder_content.hpp"
#include "support/program.hpp"
#include "support/small_log.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

ProgramResult kissmap(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), KISSMAP_BINARY);
  return run_program(arguments);
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

nlohmann::json manifest_of(const fs::path& session) {
  return nlohmann::json::parse(file_text(session / "session.json"));
}

class Cli : public testing::Test {
 protected:
  fs::path path(const std::string& name) const { return temp_.path() / name; }
  std::string small_log(int scans = 12) const {
    write_small_log(path("log"), scans);
    return path("log");
  }
  ProgramResult run(const std::string& log, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"run", log, "-o", path("session").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return kissmap(arguments);
  }

 private:
  TempDir temp_;
};

TEST_F(Cli, VersionAndHelpSucceed) {
  EXPECT_THAT(kissmap({"--version"}).out, HasSubstr("kissmap 0."));
  for (const std::string command :
       {"run", "optimize", "info", "pack", "eval", "export-cloud", "formats", "config"}) {
    EXPECT_THAT(kissmap({"--help"}).out, HasSubstr(command));
    const ProgramResult help = kissmap({command, "--help"});
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_THAT(help.out, Not(IsEmpty()));
  }
}

TEST_F(Cli, DefaultConfigurationIsTheOneInConfig) {
  EXPECT_EQ(kissmap({"config"}).out,
            file_text(fs::path(KISSMAP_SOURCE_DIR) / "config/default.toml"));
}

TEST_F(Cli, EveryKeyIsAFlagWithUnitAndDefault) {
  const std::string help = kissmap({"run", "--help"}).out;
  std::istringstream lines(kissmap({"config"}).out);
  int keys = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find(" = ");
    if (equals == std::string::npos) continue;
    std::string flag = "--" + line.substr(0, equals);
    std::ranges::replace(flag, '_', '-');
    const std::string value = line.substr(equals + 3, line.find("  #") - equals - 3);
    EXPECT_THAT(help, HasSubstr(flag + " "));
    EXPECT_THAT(help, HasSubstr("(" + value + ")"));
    ++keys;
  }
  EXPECT_GE(keys, 15);
}

TEST_F(Cli, UsageErrorsExitWith2AndSayWhatIsWrong) {
  const std::string log = small_log(2);
  write_text(path("typo.toml"), "[odometry]\n\nmax_rage = 50.0\n");
  write_text(path("section.toml"), "max_range = 50.0\n");
  write_text(path("text.toml"), "[odometry]\nmax_range = \"far\"\n");
  write_text(path("low.toml"), "[local_maps]\nsplitting_distance = -3\n");
  write_text(path("other.toml"), "{\"odometry\": {\"max_range\": 50}}\n");
  const std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> cases{
      {{"--config", path("typo.toml")}, {"typo.toml:3", "max_rage", "max_range"}},
      {{"--config", path("section.toml")}, {"section.toml:1", "[odometry]"}},
      {{"--config", path("text.toml")}, {"text.toml:2", "max_range", "far"}},
      {{"--config", path("low.toml")}, {"splitting_distance", "-3"}},
      {{"--config", path("other.toml")}, {"other.toml", "unknown key"}},
      {{"--config", path("absent.toml")}, {"absent.toml"}},
      {{"--max-range", "-1"}, {"max_range", "-1"}},
      {{"--max-range", "nan"}, {"max_range"}},
      {{"--max-range", "10m"}, {"--max-range", "10m"}},
      {{"--deskew", "perhaps"}, {"--deskew", "perhaps"}},
      {{"--time-unit", "fortnights"}, {"time_unit", "fortnights"}},
      {{"--max-rage", "5"}, {"--max-rage"}},
      {{"--every", "0"}, {"every"}},
      {{"--first", "5", "--last", "2"}, {"first"}},
      {{"--first", "-1"}, {"--first", "-1"}},
      {{"--every", "99999999999999999999"}, {"--every"}},
      {{"--format", "tape"}, {"tape", "kitti"}},
      {{"--threads", "-2"}, {"--threads"}},
  };
  for (const auto& [arguments, expected] : cases) {
    const ProgramResult result = run(log, arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments[0] << " " << result.err;
    for (const std::string& part : expected) EXPECT_THAT(result.err, HasSubstr(part));
  }
  EXPECT_FALSE(fs::exists(path("session")));
  EXPECT_FALSE(fs::exists(path("session.partial"))) << "checked before anything is written";
  EXPECT_EQ(kissmap({}).exit_code, 2);
  EXPECT_EQ(kissmap({"fly"}).exit_code, 2);
  EXPECT_EQ(kissmap({"run", log}).exit_code, 2);
}

TEST_F(Cli, RunLeavesACompleteSession) {
  const ProgramResult result = run(small_log());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("12 used of 12"), HasSubstr("map.png")));
  EXPECT_THAT(result.err, IsEmpty()) << "no progress without a terminal";
  for (const char* file : {"session.json",
                           "config.toml",
                           "scans.csv",
                           "local_maps.csv",
                           "local_maps/000000.ply",
                           "keyposes.csv",
                           "poses.csv",
                           "closures.csv",
                           "pose_graph.g2o",
                           "trajectory.tum",
                           "trajectory_kitti.txt",
                           "map.png"}) {
    EXPECT_TRUE(fs::exists(path("session") / file)) << file;
  }
  EXPECT_FALSE(fs::exists(path("session.partial")));
  std::istringstream tum(file_text(path("session") / "trajectory.tum"));
  std::string stamp;
  double x = 0.0;
  for (std::string line; std::getline(tum, line);) {
    if (line.starts_with("#")) continue;
    std::istringstream(line) >> stamp >> x;
  }
  EXPECT_EQ(stamp, "1700000001.100000000");
  EXPECT_NEAR(x, Gallery::map_from_lidar(11).translation.x(), 0.1);
}

TEST_F(Cli, RunLeavesLoopsOpenIfAsked) {
  ASSERT_EQ(run(small_log(), {"--no-loop-closing"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(path("session") / "closures.csv"));
  EXPECT_FALSE(fs::exists(path("session") / "poses.csv"));
  EXPECT_THAT(file_text(path("session") / "config.toml"), HasSubstr("loop_closing = false"));
}

TEST_F(Cli, SameBytesForEveryRunAndAnyNumberOfThreads) {
  const std::string log = small_log(40);
  ASSERT_EQ(run(log, {"--threads", "1", "--splitting-distance", "5"}).exit_code, 0);
  const auto first = content_of(path("session"));
  for (const char* threads : {"1", "2", "5"}) {
    ASSERT_EQ(
        run(log, {"--threads", threads, "--splitting-distance", "5", "--overwrite"}).exit_code, 0);
    const auto again = content_of(path("session"));
    ASSERT_EQ(again.size(), first.size());
    for (const auto& [name, content] : first) EXPECT_TRUE(again.at(name) == content) << name;
  }
}

TEST_F(Cli, FlagsWinOverTheFileAndBothAreRecorded) {
  write_text(path("my.toml"), "[odometry]\nmax_range = 60.0\nmin_range = 0.5 # near\n");
  ASSERT_EQ(run(small_log(3), {"--config", path("my.toml"), "--max-range", "70"}).exit_code, 0);
  const std::string config = file_text(path("session/config.toml"));
  EXPECT_THAT(config, AllOf(HasSubstr("max_range = 70.0"), HasSubstr("min_range = 0.5")));
  // The recorded configuration is one that can be used.
  ASSERT_EQ(run(path("log"), {"--config", path("session/config.toml"), "--overwrite"}).exit_code,
            0);
  EXPECT_EQ(file_text(path("session/config.toml")), config);
}

TEST_F(Cli, SelectsScans) {
  const std::string log = small_log(12);
  ASSERT_EQ(run(log, {"--first", "2", "--last", "9", "--every", "3"}).exit_code, 0);
  const std::string rows = file_text(path("session/scans.csv"));
  EXPECT_THAT(rows, AllOf(HasSubstr("\n2,"), HasSubstr("\n5,"), HasSubstr("\n8,")));
  EXPECT_EQ(manifest_of(path("session"))["counts"]["scans_used"], 3);
}

TEST_F(Cli, RefusesToReplaceWhatItDidNotMake) {
  const std::string log = small_log(2);
  fs::create_directories(path("session"));
  write_text(path("session/thesis.tex"), "precious");
  EXPECT_EQ(run(log).exit_code, 4);
  EXPECT_EQ(run(log, {"--overwrite"}).exit_code, 4);
  EXPECT_EQ(file_text(path("session/thesis.tex")), "precious");
  fs::remove_all(path("session"));
  ASSERT_EQ(run(log).exit_code, 0);
  const ProgramResult again = run(log);
  EXPECT_EQ(again.exit_code, 4);
  EXPECT_THAT(again.err, HasSubstr("--overwrite"));
  EXPECT_EQ(run(log, {"--overwrite", "--quiet"}).out, "");
}

TEST_F(Cli, BadLogsExitWith3AndAreNamed) {
  fs::create_directories(path("empty"));
  fs::create_directories(path("notes"));
  write_text(path("notes/readme.txt"), "nothing to see");
  fs::create_directories(path("nan"));
  const float nan = std::nanf("");
  write_pcd(path("nan") / scan_name(0), {{nan, nan, nan}, {nan, 1.0F, 2.0F}});
  fs::create_directories(path("liar"));
  write_text(path("liar") / "000000.pcd", "ply\nformat ascii 1.0\nend_header\n");
  for (const char* name : {"absent", "empty", "notes", "nan", "liar"}) {
    const ProgramResult result = run(path(name));
    EXPECT_EQ(result.exit_code, 3) << name << ": " << result.err;
    EXPECT_THAT(result.err, HasSubstr(path(name).string()));
    EXPECT_FALSE(fs::exists(path("session"))) << name;
  }
}

TEST_F(Cli, OneScanIsAMap) {
  const ProgramResult result = run(small_log(1));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("1 used of 1"));
}

TEST_F(Cli, BadScansAreLeftOutCountedAndReported) {
  const std::string log = small_log(20);
  const float nan = std::nanf("");
  write_pcd(path("log") / scan_name(3), {{nan, nan, nan}});
  fs::resize_file(path("log") / scan_name(5), 1000);
  fs::resize_file(path("log") / scan_name(6), 0);
  write_text(path("log") / scan_name(7), "this is no point cloud\n");
  write_pcd(path("log") / scan_name(9), {});
  const ProgramResult result = run(log);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("15 used of 20"),
                    HasSubstr(scan_name(5)),
                    HasSubstr(scan_name(6)),
                    HasSubstr(scan_name(7))));
  const auto counts = manifest_of(path("session"))["counts"];
  EXPECT_EQ(counts["scans_used"], 15);
  EXPECT_EQ(counts["points_dropped"]["non_finite"], 1);
}

TEST_F(Cli, StampsOutOfOrderAreLeftOutAndGapsReported) {
  write_small_log(path("log"), 20);
  std::string times;
  for (int i = 0; i < 20; ++i) {
    double stamp = 100.0 + 0.1 * i + (i >= 12 ? 30.0 : 0.0);
    if (i == 4) stamp = 100.3;  // as scan 3
    if (i == 7) stamp = 99.0;
    times += std::to_string(stamp) + "\n";
    fs::rename(path("log") / scan_name(i), path("log") / ("scan" + std::to_string(i) + ".pcd"));
  }
  write_text(path("log/times.txt"), times);
  const ProgramResult result = run(path("log"));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("18 used of 20"),
                    HasSubstr("equals"),
                    HasSubstr("earlier"),
                    HasSubstr("a gap of 30.1 s before scan 12")));
}

TEST_F(Cli, AStampFarAheadCostsOnlyItsOwnScan) {
  for (const int wrong : {0, 4}) {
    fs::remove_all(path("log"));
    write_small_log(path("log"), 12);
    std::string times;
    for (int i = 0; i < 12; ++i) {
      times += std::to_string(i == wrong ? 99999.0 : 100.0 + 0.1 * i) + "\n";
      fs::rename(path("log") / scan_name(i), path("log") / ("scan" + std::to_string(i) + ".pcd"));
    }
    write_text(path("log/times.txt"), times);
    const ProgramResult result = run(path("log"), {"--overwrite"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, AllOf(HasSubstr("11 used of 12"), HasSubstr("later than")));
  }
}

TEST_F(Cli, NeverReplacesTheLogItReads) {
  const std::string log = small_log(4);
  ASSERT_EQ(run(log, {"--pack"}).exit_code, 0);
  const auto before = content_of(path("session"));
  for (const std::string own : {"session", "session/", "session/packed_log.kmpack"}) {
    const ProgramResult result = run(path(own), {"--overwrite"});
    EXPECT_EQ(result.exit_code, 2) << own;
    EXPECT_THAT(result.err, HasSubstr("holds the log"));
  }
  EXPECT_EQ(content_of(path("session")), before);
}

TEST_F(Cli, NamedPipesAreNoLogs) {
  const std::string log = small_log(4);
  ASSERT_EQ(::mkfifo((path("log") / scan_name(9)).c_str(), 0600), 0);
  const ProgramResult result = run(log);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("4 used of 5"), HasSubstr("is not a file")));
  ASSERT_EQ(::mkfifo(path("pipe.ply").c_str(), 0600), 0);
  EXPECT_EQ(kissmap({"info", path("pipe.ply")}).exit_code, 3);
}

TEST_F(Cli, InfoTellsWhatIsInALogAndASession) {
  const std::string log = small_log(12);
  const ProgramResult of_log = kissmap({"info", log, "--all"});
  EXPECT_EQ(of_log.exit_code, 0) << of_log.err;
  EXPECT_THAT(of_log.out,
              AllOf(HasSubstr("12"), HasSubstr("115,200 returns"), HasSubstr("1.100 s")));
  ASSERT_EQ(run(log).exit_code, 0);
  const ProgramResult of_session = kissmap({"info", path("session")});
  EXPECT_EQ(of_session.exit_code, 0) << of_session.err;
  EXPECT_THAT(of_session.out, AllOf(HasSubstr(log), HasSubstr("12 used of 12")));
  EXPECT_EQ(kissmap({"info", path("absent")}).exit_code, 3);
}

TEST_F(Cli, FormatsAreListed) {
  const ProgramResult result = kissmap({"formats"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("kitti"), HasSubstr("packed")));
}

TEST_F(Cli, APackedSessionTravelsAlone) {
  const std::string log = small_log(20);
  const ProgramResult packed = run(log, {"--pack"});
  ASSERT_EQ(packed.exit_code, 0) << packed.err;
  EXPECT_THAT(packed.out, HasSubstr("bytes/point"));
  fs::remove_all(log);
  fs::rename(path("session"), path("elsewhere"));
  const ProgramResult again = run(path("elsewhere"));
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("20 used of 20"));
  EXPECT_THAT(kissmap({"info", path("elsewhere")}).out, HasSubstr("bytes/point"));
}

TEST_F(Cli, PackReadsTheLogAgainAndRefusesAChangedOne) {
  const std::string log = small_log(10);
  ASSERT_EQ(run(log, {"--pack"}).exit_code, 0);
  const std::string at_once = file_text(path("session/packed_log.kmpack"));
  ASSERT_EQ(run(log, {"--overwrite"}).exit_code, 0);

  fs::rename(log, path("moved"));
  EXPECT_EQ(kissmap({"pack", path("session")}).exit_code, 3) << "the log is gone";
  const ProgramResult later = kissmap({"pack", path("session"), "--log", path("moved")});
  ASSERT_EQ(later.exit_code, 0) << later.err;
  EXPECT_TRUE(file_text(path("session/packed_log.kmpack")) == at_once);

  ASSERT_EQ(run(path("moved"), {"--overwrite"}).exit_code, 0);
  std::fstream file(path("moved") / scan_name(4), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(1000);
  file.write("abcd", 4);
  file.close();
  const ProgramResult changed = kissmap({"pack", path("session")});
  EXPECT_EQ(changed.exit_code, 3);
  EXPECT_THAT(changed.err, AllOf(HasSubstr(scan_name(4)), HasSubstr("changed")));
  EXPECT_FALSE(fs::exists(path("session/packed_log.kmpack")));
}

TEST_F(Cli, UnwritablePlacesExitWith4) {
  const std::string log = small_log(2);
  EXPECT_EQ(kissmap({"run", log, "-o", "/proc/nowhere/session"}).exit_code, 4);
  EXPECT_EQ(run_program({KISSMAP_BINARY, "config"}, "/dev/full").exit_code, 4);
}

}  // namespace
}  // namespace kissmap
