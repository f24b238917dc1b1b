// SPDX-License-Identifier: MIT
#include "declare_export_voxels.hpp"

#include <CLI/CLI.hpp>

#include "declare_how.hpp"

namespace kissmap {

CLI::App& declare_export_voxels(CLI::App& app, ExportVoxelsCommand& c) {
  CLI::App& command = *app.add_subcommand(
      "export-voxels", "Write a 3D occupancy map (OctoMap, OpenVDB) from rays of each scan");
  command.add_option("SESSION", c.session, "session folder")->required();
  command
      .add_option("-o,--output",
                  c.output,
                  "by ending: .bt (OctoMap: occupied, free), .ot (OctoMap: log-odds), .vdb "
                  "(OpenVDB: log-odds), .pcd or .ply (centres of occupied voxels, probability as "
                  "intensity)")
      ->required()
      ->type_name("FILE");
  command
      .add_option("--resolution",
                  c.resolution,
                  "side of a voxel [m] (0.05 indoors, 0.2 where things are farther)")
      ->type_name("R");
  command
      .add_option("--threshold",
                  c.threshold,
                  "a voxel is occupied above this probability, after one hit it is 0.7; .ot and "
                  ".vdb leave it to their readers (0.5)")
      ->type_name("P");
  declare_no_return_range(command, c);
  declare_frame(command, c);
  declare_max_memory(command, c);
  declare_how(command, c, "replace FILE");
  return command;
}

}  // namespace kissmap
