// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <functional>
#include <map>
#include <new>

#include "commands.hpp"
#include "declare_convert.hpp"
#include "declare_eval.hpp"
#include "declare_export_cloud.hpp"
#include "declare_export_grid.hpp"
#include "declare_export_voxels.hpp"
#include "declare_how.hpp"
#include "declare_log.hpp"
#include "declare_optimize.hpp"
#include "kissmap/error.hpp"
#include "kissmap/version.hpp"
#include "report.hpp"

namespace kissmap {
namespace {

constexpr const char* footer =
    "Exit codes: 0 done, 1 internal error, 2 usage or configuration, 3 input, 4 output.";

/// All commands of the program: what was parsed for each, and what to call for it.
struct Commands {
  RunCommand run;
  InfoCommand info;
  ConvertCommand convert;
  PackCommand pack;
  ProductsCommand products;
  OptimizeCommand optimize;
  ExportGridCommand export_grid;
  EvalCommand eval;
  ExportCloudCommand export_cloud;
  ExportVoxelsCommand export_voxels;
  std::map<const CLI::App*, std::function<void()>> action;
};

void declare_run(CLI::App& app, Commands& commands) {
  RunCommand& c = commands.run;
  CLI::App* command = app.add_subcommand("run", "Map a recorded log: LOG in, SESSION folder out");
  command->add_option("LOG", c.log, "recorded log: folder or file, see `kissmap formats`")
      ->required();
  command->add_option("-o,--output", c.session, "session folder to write")
      ->required()
      ->type_name("SESSION");
  command->add_option("--format", c.format, "format of the log (default: found by looking at it)")
      ->type_name("NAME");
  declare_selection(*command, c.selection);
  command
      ->add_option("--threads",
                   c.threads,
                   "threads for computing (0: one a processor); the result is the same for any")
      ->type_name("N")
      ->check(CLI::Range(0, 1024));
  command->add_flag("--no-loop-closing", c.no_loop_closing, "pure odometry: leave drift as it is");
  command->add_flag("--pack", c.pack, "store the scans in the session, so that it travels alone");
  command->add_flag(
      "--no-products", c.no_products, "write no cloud, voxels and grid into SESSION/products");
  command->add_flag("--overwrite", c.overwrite, "replace SESSION if it is a session");
  command->add_flag("--quiet", c.quiet, "print errors only");
  c.configuration.add_to(*command);
  commands.action[command] = [&c] { run(c); };
}

void declare_others(CLI::App& app, Commands& commands) {
  CLI::App* about = app.add_subcommand("info", "Tell what is in a log or a session");
  about->add_option("PATH", commands.info.path, "log or session")->required();
  declare_log(*about, commands.info.format, commands.info.options);
  about->add_flag(
      "--all",
      commands.info.all,
      "of a log: read it whole, counts, bad scans, gaps; of a session: all its closures");
  commands.action[about] = [&c = commands.info] { info(c); };

  commands.action[&declare_convert(app, commands.convert)] = [&c = commands.convert] {
    convert(c);
  };

  CLI::App* pack_command = app.add_subcommand(
      "pack", "Store every usable return of the log inside its session (steps of 2 mm)");
  pack_command->add_option("SESSION", commands.pack.session, "session folder")->required();
  pack_command->add_option("--log", commands.pack.log, "where the log is now, if it moved")
      ->type_name("PATH");
  commands.action[pack_command] = [&c = commands.pack] { pack(c); };

  CLI::App* products = app.add_subcommand(
      "products", "Write the default products of a session anew: cloud, voxels and grid");
  products->add_option("SESSION", commands.products.session, "session folder")->required();
  declare_how_computed(*products, commands.products);
  commands.action[products] = [&c = commands.products] { write_products(c); };

  commands.action[&declare_optimize(app, commands.optimize)] = [&c = commands.optimize] {
    optimize(c);
  };
  commands.action[&declare_export_grid(app, commands.export_grid)] = [&c = commands.export_grid] {
    export_grid(c);
  };
  commands.action[&declare_export_cloud(app, commands.export_cloud)] =
      [&c = commands.export_cloud] { export_cloud(c); };
  commands.action[&declare_export_voxels(app, commands.export_voxels)] =
      [&c = commands.export_voxels] { export_voxels(c); };
  commands.action[&declare_eval(app, commands.eval)] = [&c = commands.eval] { eval(c); };

  commands.action[app.add_subcommand("formats", "List the log formats")] = list_formats;
  commands.action[app.add_subcommand("config", "Print the default configuration (TOML)")] =
      print_default_configuration;
}

int dispatch(const CLI::App& app, const Commands& commands) {
  try {
    commands.action.at(app.get_subcommands().front())();
    if (std::fflush(stdout) != 0) throw Error(Fault::output, "standard output cannot be written");
    return 0;
  } catch (const Error& error) {
    std::fprintf(stderr, "kissmap: %s\n", printable(error.what(), true).c_str());
    return static_cast<int>(error.fault());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "kissmap: out of memory\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kissmap: internal error: %s\n", error.what());
  }
  return static_cast<int>(Fault::internal);
}

int main_of(int argc, char** argv) {
  CLI::App app("kissmap turns recorded 3D LiDAR logs into maps a robot can navigate with.",
               "kissmap");
  app.set_version_flag("--version", std::string("kissmap ") + version());
  app.footer(footer);
  app.require_subcommand(1);
  Commands commands;
  declare_run(app, commands);
  declare_others(app, commands);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : static_cast<int>(Fault::usage);
  }
  return dispatch(app, commands);
}

}  // namespace
}  // namespace kissmap

int main(int argc, char** argv) try {
  // A file beyond the process's limit is an error to report, not the end.
  std::signal(SIGXFSZ, SIG_IGN);
  return kissmap::main_of(argc, argv);
} catch (const std::exception& error) {
  std::fprintf(stderr, "kissmap: internal error: %s\n", error.what());
  return static_cast<int>(kissmap::Fault::internal);
}
