// SPDX-License-Identifier: MIT
#include "declare_export_grid.hpp"

#include <CLI/CLI.hpp>

#include "declare_how.hpp"

namespace kissmap {
namespace {

void declare_band(CLI::App& command, ExportGridCommand& c) {
  command
      .add_option("--for",
                  c.purpose,
                  "what the map is for: navigation (0.1 to 1.8 m: whatever a robot could hit) or "
                  "localization (0.1 to 0.2 m: thin clean walls) (navigation)")
      ->type_name("navigation|localization")
      ->check(CLI::IsMember({"navigation", "localization"}));
  command.add_option("--z-min", c.z_min, "lower end of the band [m] (by --for)")->type_name("Z");
  command.add_option("--z-max", c.z_max, "upper end of the band [m] (by --for)")->type_name("Z");
  command
      .add_option_function<std::string>(
          "--z-reference",
          [&c](const std::string& name) { c.floor_reference = name == "floor"; },
          "what heights are measured from: floor (follows ramps and hills, one map for each "
          "storey) or map (the level of the first local map's ground) (floor)")
      ->type_name("floor|map")
      ->check(CLI::IsMember({"floor", "map"}));
  command
      .add_option("--resolution",
                  c.resolution,
                  "side of a cell [m] (0.05 indoors, 0.1 or 0.2 where things are farther)")
      ->type_name("R");
}

void declare_rule(CLI::App& command, ExportGridCommand& c) {
  command
      .add_option(
          "--threshold",
          c.threshold,
          "a voxel is occupied above this probability, after one hit it is 0.7 (navigation 0.65, "
          "localization 0.5); a cell is if any voxel over it in the band is")
      ->type_name("P");
  command
      .add_option("--min-free",
                  c.rule.min_free,
                  "share of the seen voxels that must be free for a free cell (0.5)")
      ->type_name("S");
  command
      .add_option("--min-seen",
                  c.rule.min_seen,
                  "share of the band that must be seen for a free cell (0: one voxel)")
      ->type_name("S");
}

}  // namespace

CLI::App& declare_export_grid(CLI::App& app, ExportGridCommand& c) {
  CLI::App& command = *app.add_subcommand(
      "export-grid", "Write a 2D occupancy map (PGM and YAML) for navigation and localisation");
  command.add_option("SESSION", c.session, "session folder")->required();
  command
      .add_option("-o,--output",
                  c.output,
                  "name of the map: NAME.pgm, NAME.yaml and NAME_look.png are written")
      ->required()
      ->type_name("NAME");
  declare_band(command, c);
  declare_rule(command, c);
  command
      .add_option(
          "--mode",
          c.mode,
          "trinary: free, occupied, unknown (PGM); scale: graded (PNG with alpha) (trinary)")
      ->type_name("trinary|scale")
      ->check(CLI::IsMember({"trinary", "scale"}));
  command
      .add_option("--min-group",
                  c.min_group,
                  "remove groups of fewer occupied cells than this (localization 0; navigation 2 "
                  "of what rests on single returns)")
      ->type_name("N")
      ->check(CLI::Range(0, 1'000'000));
  command
      .add_option("--half-width",
                  c.half_width,
                  "what carried the sensor reaches this far to all sides [m]: where it went, "
                  "nothing up to the sensor's height is occupied; 0 to keep it (0.25, 0.8 in cars)")
      ->type_name("M")
      ->check(CLI::Range(0.0, 5.0));
  command.add_flag("--connected", c.connected, "free only what is connected to the path");
  command.add_flag(
      "--align-axes", c.align_axes, "turn the map so that most walls run along x and y");
  command.add_option("--crop", c.crop, "only this part: x and y, lower and upper corner [m]")
      ->type_name("X_MIN,Y_MIN,X_MAX,Y_MAX")
      ->delimiter(',')
      ->expected(4);
  declare_no_return_range(command, c);
  declare_max_memory(command, c);
  declare_how(command, c, "replace files of that name");
  return command;
}

}  // namespace kissmap
