// SPDX-License-Identifier: MIT
// kissmap optimize SESSION, as a user calls it, on a log that goes round a yard.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "support/folder_content.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"
#include "support/yard_log.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::IsEmpty;

ProgramResult kissmap(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), KISSMAP_BINARY);
  return run_program(arguments);
}

class OptimizeSession : public testing::Test {
 protected:
  fs::path path(const std::string& name) const { return temp_.path() / name; }

  /// A session of the yard, and a copy to work on.
  void make_session(std::vector<std::string> more = {}) {
    write_yard_log(path("log"));
    std::vector<std::string> arguments{
        "run", "--no-products", path("log"), "-o", path("original"), "--splitting-distance", "10"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = kissmap(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    original_ = content_of(path("original"));
    restore();
  }
  void restore() const {
    fs::remove_all(path("session"));
    fs::copy(path("original"), path("session"), fs::copy_options::recursive);
  }
  std::string edits(const std::string& text, const std::string& name = "edits.txt") const {
    std::ofstream(path(name)) << text;
    return path(name);
  }
  ProgramResult optimize(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"optimize", path("session")});
    return kissmap(more);
  }
  std::map<std::string, std::string> content(const std::string& name = "session") const {
    return content_of(path(name));
  }

  struct Row {
    std::vector<std::string> cells;
    std::string pair() const { return cells[0] + " " + cells[1]; }
    const std::string& reason() const { return cells.back(); }
    const std::string& verdict() const { return cells[cells.size() - 2]; }
    const std::string& source() const { return cells[4]; }
    std::string pose() const {
      std::string words;
      for (std::size_t i = 11; i < 18; ++i) words += " " + cells[i];
      return words;
    }
  };
  std::vector<Row> closures(const std::string& name = "session") const {
    std::istringstream lines(file_text(path(name) / "closures.csv"));
    std::vector<Row> rows;
    for (std::string line; std::getline(lines, line);) {
      Row row;
      std::istringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) row.cells.push_back(cell);
      rows.push_back(row);
    }
    rows.erase(rows.begin());
    return rows;
  }
  /// The first candidate of the original with this reason whose pair has no other.
  Row candidate(const std::string& reason) const {
    const std::vector<Row> rows = closures("original");
    for (const Row& row : rows) {
      const auto same = [&row](const Row& other) { return other.pair() == row.pair(); };
      if (row.reason() == reason && std::ranges::count_if(rows, same) == 1) return row;
    }
    ADD_FAILURE() << "no candidate: " << reason;
    return rows.front();
  }
  std::vector<std::string> reasons(const std::string& pair) const {
    std::vector<std::string> found;
    for (const Row& row : closures()) {
      if (row.pair() == pair) found.push_back(row.source() + ": " + row.reason());
    }
    return found;
  }

  std::map<std::string, std::string> original_;

 private:
  TempDir temp_;
};

TEST_F(OptimizeSession, WithoutEditsReproducesEveryByteOfTheRun) {
  make_session({"--pack"});
  ASSERT_EQ(candidate("accepted").verdict(), "accepted");
  const ProgramResult in_place = optimize();
  ASSERT_EQ(in_place.exit_code, 0) << in_place.err;
  EXPECT_THAT(in_place.out, AllOf(HasSubstr("loops "), HasSubstr("0.000 m at most")));
  EXPECT_THAT(differing(original_, content()), IsEmpty());
  fs::remove_all(path("log"));
  const ProgramResult copied = optimize({"-o", path("copy"), "--quiet"});
  ASSERT_EQ(copied.exit_code, 0) << copied.err;
  EXPECT_EQ(copied.out, "");
  EXPECT_THAT(differing(original_, content("copy")), IsEmpty());
  ASSERT_EQ(kissmap({"run", "--no-products", path("copy"), "-o", path("again")}).exit_code, 0)
      << "packed";
  const ProgramResult over_its_log =
      kissmap({"optimize", path("again"), "-o", path("copy"), "--overwrite"});
  EXPECT_EQ(over_its_log.exit_code, 2);
  EXPECT_THAT(over_its_log.err, HasSubstr("holds the log"));
}

TEST_F(OptimizeSession, EditsAreShownKeptReplayedAndUndone) {
  make_session();
  const Row wrong = candidate("accepted");
  const Row missing = candidate("overlap too low");
  const std::string text = "# by me\nremove " + wrong.pair() + "\nfix " + missing.pair() +
                           "\nadd " + wrong.pair() + "\n";
  const ProgramResult result = optimize({"--edits", edits(text)});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("refused   " + wrong.pair() + ": removed by hand"),
                    HasSubstr("closed    " + missing.pair() + ": fixed by hand; overlap too low"),
                    HasSubstr("closed    " + wrong.pair() + ": added by hand"),
                    HasSubstr("kept in")));
  EXPECT_THAT(reasons(wrong.pair()),
              testing::ElementsAre(wrong.source() + ": removed by hand", "hand: added by hand"));
  EXPECT_THAT(reasons(missing.pair()),
              testing::ElementsAre(missing.source() + ": fixed by hand; overlap too low"));
  const auto edited = content();
  EXPECT_EQ(edited.at("edits.txt"), text);
  for (const char* file : {"keyposes.csv",
                           "poses.csv",
                           "trajectory.tum",
                           "trajectory_kitti.txt",
                           "pose_graph.g2o",
                           "map.png"}) {
    EXPECT_NE(edited.at(file), original_.at(file)) << file;
  }
  const ProgramResult info = kissmap({"info", path("session")});
  EXPECT_THAT(info.out,
              AllOf(HasSubstr("refused   1: removed by hand"), HasSubstr("closed    1: added by")));

  EXPECT_EQ(optimize().exit_code, 0);
  EXPECT_THAT(differing(edited, content()), IsEmpty()) << "replayed from its own edits";
  EXPECT_EQ(optimize({"--edits", edits("fix " + wrong.pair() + "\n")}).exit_code, 0);
  EXPECT_EQ(optimize({"--edits", edits(text)}).exit_code, 0);
  EXPECT_THAT(differing(edited, content()), IsEmpty()) << "whatever was there before";
  EXPECT_EQ(optimize({"--edits", edits("# nothing\n\n")}).exit_code, 0);
  EXPECT_THAT(differing(original_, content()), IsEmpty()) << "undone";
}

TEST_F(OptimizeSession, APoseCanBeGivenAndAGuess) {
  make_session();
  const Row row = candidate("accepted");
  // The poses of closures.csv are of the query in the reference.
  const std::string to_query = row.cells[1] + " " + row.cells[0];
  ASSERT_EQ(
      optimize({"--edits",
                edits("remove " + row.pair() + "\nadd " + to_query + row.pose() + " 0.05 0.005\n")})
          .exit_code,
      0);
  EXPECT_EQ(closures().back().pose(), row.pose());
  EXPECT_EQ(closures().back().reason(), "added by hand");
  const ProgramResult near = optimize(
      {"--edits", edits("remove " + row.pair() + "\nadd " + to_query + " near" + row.pose())});
  ASSERT_EQ(near.exit_code, 0) << near.err;
  EXPECT_EQ(closures().back().reason(), "added by hand");
  const ProgramResult lost = optimize(
      {"--edits", edits("remove " + row.pair() + "\nadd " + to_query + " near 500 0 0 0 0 0 1\n")});
  EXPECT_EQ(lost.exit_code, 3);
  EXPECT_THAT(lost.err, AllOf(HasSubstr("edits.txt:2: "), HasSubstr("do not fit together")));
}

TEST_F(OptimizeSession, HostileEditsAreNamedAndChangeNothing) {
  make_session();
  const Row closed = candidate("accepted");
  const Row refused = candidate("overlap too low");
  const std::vector<std::pair<std::string, std::string>> cases{
      {"remove 0 99\n", "edits.txt:1: there is no local map 99"},
      {"\nremove 0 99999999999\n", "edits.txt:2: there is no local map 99999999999"},
      {"remove 0 99999999999999999999\n", "not a whole number"},
      {"remove -1 0\n", "edits.txt:1: FROM is '-1'"},
      {"remove 1 1\n", "the same"},
      {"remove 1 2\n", "edits.txt:1: there is no closure between 1 and 2"},
      {"fix 1 2\n", "there is no closure and no candidate between 1 and 2"},
      {"remove " + refused.pair() + "\n", "is refused already: overlap too low"},
      {"remove " + closed.pair() + "\nremove " + closed.pair() + "\n",
       "edits.txt:2: the closure between"},
      {"add " + closed.pair() + "\n", "already; remove it first"},
      {"add " + refused.pair() + refused.pose() + "\nadd " + refused.pair() + "\n",
       "edits.txt:2: there is a closure"},
      {"add 0 1 1e300 0 0 0 0 0 1\n", "100 km"},
      {"add 0 1 nan 0 0 0 0 0 1\n", "not a finite number"},
      {"add 0 1 1 2 3 0 0 0 0\n", "quaternion"},
      {"add 0 1 1 2 3 0 0 0 1 0 0\n", "standard deviation"},
      {"add 0 1 1 2 3 0 0 0 1 2\n", "sigma_rad is missing"},
      {std::string("\x89PNG\r\n\x1a\n\0\0", 10), "unknown edit"},
      {"open sesame", "unknown edit 'open'"}};
  for (const auto& [text, message] : cases) {
    const ProgramResult result = optimize({"--edits", edits(text)});
    EXPECT_EQ(result.exit_code, 3) << text;
    EXPECT_THAT(result.err, HasSubstr(message)) << text;
    EXPECT_THAT(differing(original_, content()), IsEmpty()) << text;
  }
  for (const std::string file : {path("absent.txt"), path("session")}) {
    EXPECT_EQ(optimize({"--edits", file}).exit_code, 3);
  }
  EXPECT_THAT(differing(original_, content()), IsEmpty());
}

TEST_F(OptimizeSession, MistakesOfUseHaveTheirExitCode) {
  make_session();
  fs::create_directories(path("precious"));
  std::ofstream(path("precious/thesis.tex")) << "mine";
  fs::copy(path("original"), path("other"), fs::copy_options::recursive);
  const std::vector<std::pair<std::vector<std::string>, std::pair<int, std::string>>> cases{
      {{"--start", "tree"}, {2, "--start: is for .g2o files"}},
      {{"--robust", "false"}, {2, "--robust: is for"}},
      {{"--max-iterations", "5"}, {2, "--max-iterations: is for"}},
      {{"--drop-coupling"}, {2, "--drop-coupling: is for"}},
      {{"--overwrite"}, {2, "--overwrite: is for -o"}},
      {{"-o", path("session")}, {2, "holds the session being read"}},
      {{"-o", path("session"), "--overwrite"}, {2, "holds the session being read"}},
      {{"-o", path("session/inside")}, {2, "holds the new session"}},
      {{"-o", path("other")}, {4, "exists already"}},
      {{"-o", path("precious"), "--overwrite"}, {4, "not a session folder"}},
      {{"-o", path("no/where")}, {4, "folder"}}};
  for (const auto& [arguments, expected] : cases) {
    const ProgramResult result = optimize(arguments);
    EXPECT_EQ(result.exit_code, expected.first) << arguments.front();
    EXPECT_THAT(result.err, HasSubstr(expected.second));
  }
  EXPECT_THAT(differing(original_, content()), IsEmpty());
  EXPECT_EQ(optimize({"-o", path("other"), "--overwrite"}).exit_code, 0);
  EXPECT_THAT(differing(original_, content("other")), IsEmpty());
  EXPECT_THAT(kissmap({"optimize", path("precious")}).err, HasSubstr("session.json"));
  EXPECT_EQ(kissmap({"optimize", path("precious")}).exit_code, 3);
  EXPECT_THAT(kissmap({"optimize", path("absent")}).err, HasSubstr("no such session folder"));
}

// Every mixture of old and new files that a stop can leave, in the order they are put in place.
TEST_F(OptimizeSession, AStoppedUpdateIsReportedAndCanBeRepeated) {
  make_session();
  const std::string file = edits("remove " + candidate("accepted").pair() + "\nfix " +
                                 candidate("overlap too low").pair() + "\n");
  ASSERT_EQ(optimize({"--edits", file, "-o", path("new")}).exit_code, 0);
  const auto wanted = content("new");
  const std::vector<std::string> order{"edits.txt",
                                       "keyposes.csv",
                                       "poses.csv",
                                       "closures.csv",
                                       "neighbors.csv",
                                       "surfaces.csv",
                                       "pose_graph.g2o",
                                       "trajectory.tum",
                                       "trajectory_kitti.txt",
                                       "map.png"};
  for (const std::size_t done : {0U, 4U}) {
    restore();
    for (std::size_t i = 0; i < done; ++i) {
      fs::copy_file(
          path("new") / order[i], path("session") / order[i], fs::copy_options::overwrite_existing);
    }
    fs::create_directories(path("session/optimize.partial"));
    fs::copy_file(path("new/map.png"), path("session/optimize.partial/map.png"));
    std::string manifest = file_text(path("session/session.json"));
    const std::string finished = "\"finished\": true,";
    manifest.replace(
        manifest.find(finished), finished.size(), "\"finished\": false,\n  \"optimizing\": true,");
    std::ofstream(path("session/session.json")) << manifest;
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"info", path("session")},
          {"pack", path("session")},
          {"eval", path("session"), "--reference", path("session")}}) {
      const ProgramResult result = kissmap(command);
      EXPECT_EQ(result.exit_code, 3) << command[0];
      EXPECT_THAT(result.err, AllOf(HasSubstr("was stopped"), HasSubstr("kissmap optimize")));
    }
    const ProgramResult again = optimize({"--edits", file});
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_THAT(differing(wanted, content()), IsEmpty()) << done << " files in place";
    EXPECT_FALSE(fs::exists(path("session/optimize.partial")));
  }
}

TEST_F(OptimizeSession, KilledAtAnyTimeItIsOldOrNewOrReported) {
  using Clock = std::chrono::steady_clock;
  make_session();
  const std::string file = edits("remove " + candidate("accepted").pair() + "\n");
  const auto begin = Clock::now();
  ASSERT_EQ(optimize({"--edits", file, "-o", path("new")}).exit_code, 0);
  const auto whole = Clock::now() - begin;
  const auto wanted = content("new");
  for (const double share : {0.5, 0.9, 1.0}) {
    restore();
    const pid_t child = ::fork();
    if (child == 0) {
      ::dup2(::open("/dev/null", O_WRONLY), STDOUT_FILENO);
      ::execl(KISSMAP_BINARY,
              KISSMAP_BINARY,
              "optimize",
              path("session").c_str(),
              "--edits",
              file.c_str(),
              static_cast<char*>(nullptr));
      ::_exit(127);
    }
    std::this_thread::sleep_for(share * whole);
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const ProgramResult info = kissmap({"info", path("session")});
    fs::remove_all(path("session/optimize.partial"));
    if (info.exit_code == 0) {
      EXPECT_THAT(content(), AnyOf(original_, wanted));
    } else {
      EXPECT_EQ(info.exit_code, 3);
      EXPECT_THAT(info.err, HasSubstr("was stopped"));
    }
    EXPECT_EQ(optimize({"--edits", file}).exit_code, 0);
    EXPECT_THAT(differing(wanted, content()), IsEmpty());
  }
}

TEST_F(OptimizeSession, AFullDiskOrAMissingLocalMapChangesNothing) {
  make_session();
  const std::string file = edits("remove " + candidate("accepted").pair() + "\n");
  // 512-byte blocks: no file of the session may grow beyond 10 kB.
  const std::vector<std::string> limited{"/bin/sh", "-c", "ulimit -f 20; exec \"$@\"", "sh"};
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"-o", path("copy")}}) {
    std::vector<std::string> command = limited;
    command.insert(command.end(), {KISSMAP_BINARY, "optimize", path("session"), "--edits", file});
    command.insert(command.end(), more.begin(), more.end());
    const ProgramResult result = run_program(command);
    EXPECT_EQ(result.exit_code, 4) << result.err;
    EXPECT_THAT(result.err, HasSubstr("free some space"));
    EXPECT_THAT(differing(original_, content()), IsEmpty());
    EXPECT_FALSE(fs::exists(path("copy")));
    EXPECT_FALSE(fs::exists(path("copy.partial")));
  }
  fs::rename(path("session/local_maps/000003.ply"), path("away"));
  for (const std::string command : {"info", "optimize"}) {
    const ProgramResult result = kissmap({command, path("session")});
    EXPECT_EQ(result.exit_code, 3) << command;
    EXPECT_THAT(result.err, HasSubstr("000003.ply"));
  }
  fs::rename(path("away"), path("session/local_maps/000003.ply"));
  EXPECT_THAT(differing(original_, content()), IsEmpty());
}

TEST_F(OptimizeSession, LoopsLeftOpenCanBeClosedByHand) {
  make_session();
  const Row row = candidate("accepted");
  make_session({"--no-loop-closing", "--overwrite"});
  const ProgramResult nothing = optimize();
  ASSERT_EQ(nothing.exit_code, 0) << nothing.err;
  EXPECT_THAT(nothing.out, AllOf(HasSubstr("left open"), HasSubstr("edits may add")));
  EXPECT_THAT(differing(original_, content()), IsEmpty());
  EXPECT_THAT(kissmap({"info", path("session")}).out, HasSubstr("loops       left open"));
  const ProgramResult removed = optimize({"--edits", edits("remove " + row.pair() + "\n")});
  EXPECT_EQ(removed.exit_code, 3);
  const ProgramResult closed = optimize({"--edits", edits("add " + row.pair() + "\n")});
  ASSERT_EQ(closed.exit_code, 0) << closed.err;
  EXPECT_THAT(closed.out, HasSubstr("1 closed, of 1 candidates"));
  EXPECT_THAT(reasons(row.pair()), testing::ElementsAre("hand: added by hand"));
  EXPECT_TRUE(fs::exists(path("session/poses.csv")));
  ASSERT_EQ(optimize({"--edits", edits("")}).exit_code, 0);
  EXPECT_THAT(differing(original_, content()), IsEmpty());
}

TEST_F(OptimizeSession, ProductsOfThePosesBeforeAreRemoved) {
  make_session();
  ASSERT_EQ(kissmap({"products", path("session"), "--quiet"}).exit_code, 0);
  ASSERT_EQ(optimize().exit_code, 0);
  EXPECT_TRUE(fs::exists(path("session") / "products")) << "nothing moved";
  const ProgramResult to_other = optimize({"-o", path("other")});
  EXPECT_FALSE(fs::exists(path("other") / "products"));
  EXPECT_TRUE(fs::exists(path("session") / "products"));
  const ProgramResult moved =
      optimize({"--edits", edits("remove " + candidate("accepted").pair() + "\n")});
  ASSERT_EQ(moved.exit_code, 0) << moved.err;
  EXPECT_THAT(moved.out, HasSubstr("kissmap products"));
  EXPECT_FALSE(fs::exists(path("session") / "products"));
}

TEST_F(OptimizeSession, InfoListsClosures) {
  make_session();
  const std::string few = kissmap({"info", path("session")}).out;
  const std::string all = kissmap({"info", path("session"), "--all"}).out;
  std::size_t accepted = 0;
  std::map<std::string, int> counts;
  for (const Row& row : closures()) {
    ++counts[row.reason()];
    accepted += row.verdict() == "accepted" ? 1 : 0;
  }
  const auto lines_after = [](const std::string& text) {
    const std::size_t head = text.find("query reference");
    const std::size_t end = text.find("  pack ");
    return std::count(text.begin() + static_cast<std::ptrdiff_t>(head),
                      text.begin() + static_cast<std::ptrdiff_t>(end),
                      '\n') -
           1;
  };
  EXPECT_THAT(all,
              HasSubstr(std::to_string(accepted) + " closed, of " +
                        std::to_string(closures().size()) + " candidates"));
  for (const auto& [reason, count] : counts) {
    EXPECT_THAT(all, HasSubstr(" " + std::to_string(count) + ": " + reason + "\n"));
  }
  ASSERT_GT(accepted, 20U);
  EXPECT_EQ(lines_after(all), static_cast<std::ptrdiff_t>(accepted));
  EXPECT_EQ(lines_after(few), 21);
  EXPECT_THAT(few, HasSubstr("and " + std::to_string(accepted - 20) + " more; --all"));
}

}  // namespace
}  // namespace kissmap
