// SPDX-License-Identifier: MIT
#include "declare_optimize.hpp"

#include <CLI/CLI.hpp>

namespace kissmap {
namespace {

constexpr const char* edits_help =
    "text file of edits, one a line: remove FROM TO, fix FROM TO (never refused), "
    "add FROM TO x y z qx qy qz qw [sigma_m sigma_rad]; in a session, whose ids are those of "
    "closures.csv, also add FROM TO [near x y z qx qy qz qw] (registered). A session keeps its "
    "edits: the file says all of them, not further ones (default: those it keeps)";

void declare_graph_options(CLI::App& command, OptimizeCommand& c) {
  const auto for_graphs = [&c](CLI::Option* option) {
    option->group("Options for .g2o files")
        ->each([&c, name = option->get_name()](const std::string&) { c.graph_option = name; });
  };
  for_graphs(command
                 .add_option("--start",
                             c.start,
                             "start values: those of the file, along a tree, or chordal "
                             "relaxation (file if it has vertices, else tree)")
                 ->type_name("file|tree|chordal")
                 ->check(CLI::IsMember({"file", "tree", "chordal"})));
  for_graphs(
      command
          .add_option("--robust", c.options.robust, "whether false closures may be refused (true)")
          ->type_name("true|false"));
  for_graphs(
      command.add_option("--max-iterations", c.options.max_iterations, "of each solve (100)")
          ->type_name("N"));
  for_graphs(command.add_flag(
      "--drop-coupling",
      c.drop_coupling,
      "where the information of an edge is negative in some direction, keep only its "
      "translation and rotation blocks instead of refusing the file"));
}

}  // namespace

CLI::App& declare_optimize(CLI::App& app, OptimizeCommand& c) {
  CLI::App& command = *app.add_subcommand(
      "optimize", "Close and open loops of a session by hand; or optimise a pose graph");
  command
      .add_option("SESSION|GRAPH",
                  c.input,
                  "session folder, or a pose graph: a .g2o file (SE2 or SE3:QUAT)")
      ->required();
  command
      .add_option("-o,--output",
                  c.output,
                  "session folder to write (default: SESSION is changed in place), or .g2o file")
      ->type_name("OUT");
  command.add_option("--edits", c.edits, edits_help)->type_name("FILE");
  command.add_flag("--overwrite", c.overwrite, "replace OUT if it is a .g2o file or a session");
  command.add_flag("--quiet", c.quiet, "print errors only");
  declare_graph_options(command, c);
  return command;
}

}  // namespace kissmap
