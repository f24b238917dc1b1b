// SPDX-License-Identifier: MIT
// kissmap optimize, as a user calls it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/program.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class OptimizeCli : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (temp_.path() / name).string(); }

  /// Twice round a square of 16 steps; closures from lap to lap, and one that is false.
  std::string square() const {
    std::ofstream out(path("square.g2o"));
    const auto edge = [&out](int from, int to, double x, double y, double theta) {
      out << "EDGE_SE2 " << from << ' ' << to << ' ' << x << ' ' << y << ' ' << theta
          << " 100 0 0 100 0 1000\n";
    };
    for (int i = 1; i < 32; ++i) edge(i - 1, i, 1.02, 0.01, i % 4 == 0 ? M_PI / 2 : 0.002);
    for (int i = 0; i < 16; ++i) edge(i, i + 16, 0.0, 0.0, 0.0);
    edge(3, 25, 5.0, 5.0, 1.0);
    return path("square.g2o");
  }
  ProgramResult optimize(std::vector<std::string> more) const {
    more.insert(more.begin(), {KISSMAP_BINARY, "optimize"});
    return run_program(more);
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
  }

 private:
  TempDir temp_;
};

TEST_F(OptimizeCli, ReportsAndWrites) {
  const ProgramResult result = optimize({square(), "-o", path("out.g2o")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("nodes       32, start from a tree"),
                    HasSubstr("edges       48, 17 of them closures"),
                    HasSubstr("converged"),
                    HasSubstr("refused     1 closures\n    3 25\n")));
  EXPECT_THAT(file_text(path("out.g2o")),
              AllOf(HasSubstr("VERTEX_SE2 31 "), HasSubstr("# refused EDGE_SE2 3 25 ")));
  // The output is a graph at its optimum.
  const ProgramResult again = optimize({path("out.g2o"), "-o", path("again.g2o")});
  EXPECT_THAT(again.out, AllOf(HasSubstr("start from the file"), HasSubstr("refused     0")));
}

TEST_F(OptimizeCli, SameBytesEveryTimeWithAndWithoutEdits) {
  write("edits.txt", "remove 3 25  # false\nfix 4 20\nadd 5 21 0.01 0 0 0 0 0 1 0.1 0.05\n");
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--edits", path("edits.txt")}}) {
    std::string first;
    for (int i = 0; i < 2; ++i) {
      std::vector<std::string> arguments{square(), "-o", path("out.g2o"), "--overwrite"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      EXPECT_EQ(optimize(arguments).exit_code, 0);
      const std::string bytes = file_text(path("out.g2o"));
      EXPECT_THAT(bytes, Not(IsEmpty()));
      if (i == 0) first = bytes;
      EXPECT_EQ(bytes, first);
    }
    EXPECT_EQ(first.find("EDGE_SE2 3 25") == std::string::npos, !more.empty());
  }
}

TEST_F(OptimizeCli, StartsAgree) {
  std::string first;
  for (const char* start : {"tree", "chordal"}) {
    const ProgramResult result =
        optimize({square(), "-o", path(start), "--start", start, "--robust", "false"});
    const std::size_t after = result.out.find("before, ");
    ASSERT_NE(after, std::string::npos) << result.err;
    const std::string cost = result.out.substr(after, 14);
    if (first.empty()) first = cost;
    EXPECT_EQ(cost, first);
    EXPECT_THAT(result.out, Not(HasSubstr("refused")));
  }
}

TEST_F(OptimizeCli, MistakesHaveTheirExitCode) {
  const std::string graph = square();
  write("bad.g2o", "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 x\n");
  write("apart.g2o",
        "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 0 0 0\nVERTEX_SE2 5 0 0 0\n"
        "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n");
  write("edits.txt", "remove 0 9\n");
  write("there.g2o", "mine");
  const std::string out = path("out.g2o");
  const std::vector<std::tuple<std::vector<std::string>, int, std::string>> cases{
      {{graph}, 2, "--output"},
      {{path("absent.g2o"), "-o", out}, 3, "absent.g2o"},
      {{path("edits.txt"), "-o", out}, 2, "is no .g2o file"},
      {{path("bad.g2o"), "-o", out}, 3, "bad.g2o:1: information is 'x'"},
      {{path("apart.g2o"), "-o", out},
       3,
       "apart.g2o: pose graph: node 2 is not tied to a fixed node"},
      {{graph, "-o", graph, "--overwrite"}, 2, "is the graph being read"},
      {{graph, "-o", path("there.g2o")}, 2, "--overwrite"},
      {{graph, "-o", path("no/out.g2o")}, 4, "create the folder first"},
      {{graph, "-o", out, "--start", "file"}, 2, "no vertices"},
      {{graph, "-o", out, "--start", "guess"}, 2, "guess"},
      {{graph, "-o", out, "--robust", "perhaps"}, 2, "perhaps"},
      {{graph, "-o", out, "--max-iterations", "0"}, 2, "max_iterations"},
      {{graph, "-o", out, "--edits", path("edits.txt")}, 3, "edits.txt:1: there is no edge"},
      {{graph, "-o", out, "--edits", path("absent.txt")}, 3, "absent.txt"}};
  for (const auto& [arguments, exit_code, message] : cases) {
    const ProgramResult result = optimize(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(out)) << message;
  }
  EXPECT_EQ(file_text(path("there.g2o")), "mine");
}

}  // namespace
}  // namespace kissmap
