// SPDX-License-Identifier: MIT
#include "declare_convert.hpp"

#include "declare_log.hpp"

namespace kissmap {

CLI::App& declare_convert(CLI::App& app, ConvertCommand& c) {
  CLI::App& command = *app.add_subcommand(
      "convert", "Write the scans of a log for other programs: stamps, points, times of points");
  command.add_option("LOG", c.log, "recorded log: folder or file, see `kissmap formats`")
      ->required();
  command.add_option("-o,--output", c.output, "folder (pcd, kitti) or file (mcap) to write")
      ->required()
      ->type_name("OUT");
  command
      .add_option(
          "--to",
          c.to,
          "pcd: a folder of PCD files and times.txt; kitti: sequences/00 as KITTI odometry, "
          "without times of points; mcap: PointCloud2 of ROS 2 on /points")
      ->required()
      ->type_name("pcd|kitti|mcap")
      ->check(CLI::IsMember({"pcd", "kitti", "mcap"}));
  declare_log(command, c.format, c.options);
  declare_selection(command, c.selection);
  command.add_flag("--quiet", c.quiet, "print errors only");
  return command;
}

}  // namespace kissmap
