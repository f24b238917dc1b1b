// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "commands.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/g2o.hpp"
#include "kissmap/formats/graph_edits.hpp"
#include "report.hpp"

namespace kissmap {
namespace {

void require_output(const OptimizeCommand& command) {
  if (command.output.empty()) throw usage_error("a graph needs --output, the .g2o file to write");
  std::error_code unresolved;
  if (std::filesystem::equivalent(command.input, command.output, unresolved)) {
    throw usage_error(command.output.string() + ": is the graph being read; name another output");
  }
  if (std::filesystem::exists(command.output, unresolved) && !command.overwrite) {
    throw usage_error(command.output.string() + ": exists; add --overwrite to replace it");
  }
}

/// What the start values come from; replaces them.
std::string set_start(const std::string& wanted, GraphFile& file) {
  std::string start = !wanted.empty() ? wanted : file.has_start ? "file" : "tree";
  if (start == "file" && !file.has_start) {
    throw usage_error("--start file: the graph has no vertices; use tree or chordal");
  }
  if (start == "tree") file.graph.map_from_node = tree_start(file.graph);
  if (start == "chordal") file.graph.map_from_node = chordal_start(file.graph);
  return start;
}

std::string refused_closures(const GraphFile& file, const PoseGraphSolution& solution) {
  constexpr std::uint64_t most = 20;  // lines
  std::uint64_t count = 0;
  std::string lines;
  for (std::size_t i = 0; i < solution.edge_weights.size(); ++i) {
    if (solution.edge_weights[i] > 0.0 || ++count > most) continue;
    const PoseGraphEdge& edge = file.graph.edges[i];
    lines += text("    %lld %lld\n",
                  static_cast<long long>(file.ids[edge.from]),
                  static_cast<long long>(file.ids[edge.to]));
  }
  if (count > most) lines += text("    and %s more\n", with_commas(count - most).c_str());
  return text("  refused     %s closures\n", with_commas(count).c_str()) + lines;
}

struct Outcome {
  std::string start;
  PoseGraphSolution solution;
  double seconds = 0.0;
};

// The library knows nodes by index and no file.
[[noreturn]] void rethrow(const Error& error, const std::filesystem::path& input) {
  if (error.fault() != Fault::input) throw error;
  throw input_error(input,
                    std::string(error.what()) + " (nodes count from 0 in order of their ids)");
}

Outcome solve(const OptimizeCommand& command, GraphFile& file) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  Outcome outcome;
  try {
    outcome.start = set_start(command.start, file);
    outcome.solution = optimize(file.graph, command.options);
  } catch (const Error& error) {
    rethrow(error, command.input);
  }
  outcome.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return outcome;
}

void report(const OptimizeCommand& command, const GraphFile& file, const Outcome& outcome) {
  const auto& [start, solution, seconds] = outcome;
  const auto closures = static_cast<std::uint64_t>(
      std::ranges::count(file.graph.edges, EdgeKind::closure, &PoseGraphEdge::kind));
  std::printf("%s\n", command.output.c_str());
  std::printf("  nodes       %s, start from %s\n",
              with_commas(file.ids.size()).c_str(),
              start == "file"   ? "the file"
              : start == "tree" ? "a tree"
                                : "chordal relaxation");
  std::printf("  edges       %s, %s of them closures\n",
              with_commas(file.graph.edges.size()).c_str(),
              with_commas(closures).c_str());
  std::printf(
      "  cost        %.10g before, %.10g after\n", solution.initial_cost, solution.final_cost);
  std::printf("  iterations  %d, %s\n",
              solution.iterations,
              solution.converged ? "converged" : "NOT converged: raise --max-iterations");
  std::printf("  time        %.3f s\n", seconds);
  if (command.options.robust) std::fputs(refused_closures(file, solution).c_str(), stdout);
  if (file.couplings_dropped > 0) {
    std::printf("  changed     %s edges: coupling of translation and rotation dropped\n",
                with_commas(file.couplings_dropped).c_str());
  }
  for (const auto& [tag, count] : file.skipped) {
    std::printf("  skipped     %s lines of unknown kind %s\n",
                with_commas(count).c_str(),
                printable(tag).c_str());
  }
}

}  // namespace

void optimize(const OptimizeCommand& command) {
  std::error_code unresolved;
  const bool is_file = std::filesystem::is_regular_file(command.input, unresolved);
  if (command.input.extension() != ".g2o" ||
      std::filesystem::is_directory(command.input, unresolved)) {
    if (!is_file) return optimize_session(command);
    throw usage_error(command.input.string() + ": is no .g2o file and no session folder");
  }
  require_output(command);
  GraphFile file = read_g2o(
      command.input,
      command.drop_coupling ? NegativeInformation::drop_coupling : NegativeInformation::refuse);
  if (!command.edits.empty()) apply(read_graph_edits(command.edits), file.ids, file.graph);
  const Outcome outcome = solve(command, file);
  file.graph.map_from_node = outcome.solution.map_from_node;
  write_g2o(file, command.output, outcome.solution.edge_weights);
  if (!command.quiet) report(command, file, outcome);
}

}  // namespace kissmap
