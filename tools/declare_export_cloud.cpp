// SPDX-License-Identifier: MIT
#include "declare_export_cloud.hpp"

#include <CLI/CLI.hpp>

#include "declare_how.hpp"

namespace kissmap {
namespace {

void declare_what(CLI::App& command, ExportCloudCommand& c) {
  const auto group = "What is exported";
  command
      .add_option(
          "--voxel-size",
          c.voxel_size,
          "thin to one real point in each cube of this size [m]: the one nearest to the mean of "
          "what was seen in it till then, 0 keeps every point "
          "(max_range of the session / 1000)")
      ->type_name("M")
      ->group(group);
  command
      .add_option(
          "--fields",
          c.fields,
          "beside x y z, any of intensity,time,normals,scan,sensor, or none: time in seconds "
          "of the log's clock, scan counts the session's scans from 0, sensor is where it was "
          "when it saw the point (intensity, where the log has it)")
      ->type_name("LIST")
      ->group(group);
  command.add_option("--color", c.colour, "adds colours: by height, those of map.png")
      ->type_name("height")
      ->check(CLI::IsMember({"height"}))
      ->group(group);
  command
      .add_option(
          "--crop", c.crop, "only what is inside this rectangle, in the frame of the cloud [m]")
      ->type_name("XMIN,YMIN,XMAX,YMAX")
      ->group(group);
  command
      .add_option("--crop-polygon",
                  c.crop_polygon,
                  "only what is inside a polygon: a text file with one corner a line, x y [m]")
      ->type_name("FILE")
      ->group(group);
  command.add_option("--z-min", c.z_min, "only what is at this height or above [m]")
      ->type_name("M")
      ->group(group);
  command.add_option("--z-max", c.z_max, "only what is at this height or below [m]")
      ->type_name("M")
      ->group(group);
  command
      .add_flag("--remove-outliers",
                c.remove_outliers,
                "leave out points that stand alone: mean distance to 10 neighbours two standard "
                "deviations above the mean")
      ->group(group);
  command
      .add_flag("--remove-dynamic",
                c.remove_dynamic,
                "leave out what moved, as rays of other scans passed through it; written to "
                "FILE_removed instead. Reads the log twice more")
      ->group(group);
}

}  // namespace

CLI::App& declare_export_cloud(CLI::App& app, ExportCloudCommand& c) {
  CLI::App& command = *app.add_subcommand(
      "export-cloud", "Write the points of a session, in their final places, as one cloud");
  command.add_option("SESSION", c.session, "session folder")->required();
  command
      .add_option(
          "-o,--output", c.output, "cloud to write: .pcd, .ply or .las; with --tiles a folder")
      ->required()
      ->type_name("FILE");
  command
      .add_option("--tiles",
                  c.tile_size,
                  "write a folder of square .pcd tiles of this size [whole m], with the "
                  "pointcloud_map_metadata.yaml of Autoware's map loader")
      ->type_name("M")
      ->check(CLI::Range(1, 100000));
  command.add_flag(
      "--compress", c.compress, "write .pcd files as binary_compressed, 4 GiB of points at most");
  declare_frame(command, c);
  declare_how(command, c, "replace FILE, or a folder that holds only tiles");
  declare_what(command, c);
  return command;
}

}  // namespace kissmap
