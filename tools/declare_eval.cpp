// SPDX-License-Identifier: MIT
#include "declare_eval.hpp"

#include <CLI/CLI.hpp>

namespace kissmap {
namespace {

void declare_inputs(CLI::App& command, EvalCommand& c) {
  command.add_option("ESTIMATE", c.estimates, "sessions or files: TUM, KITTI poses or EuRoC csv")
      ->required();
  command
      .add_option("--reference",
                  c.reference,
                  "trajectory to compare with: file, session, or the folder of nuScenes")
      ->required()
      ->type_name("FILE");
  command.add_option("--topic", c.topic, "scene, where the reference is nuScenes")
      ->type_name("SCENE");
  command
      .add_option("--times",
                  c.times,
                  "a stamp [s] a line, for all trajectories that have none (KITTI: times.txt)")
      ->type_name("FILE");
  command
      .add_option("--kitti-calib",
                  c.calibration,
                  "calib.txt: the estimates are poses of the LiDAR, the reference is of camera 0")
      ->type_name("FILE");
  command
      .add_option("--mount",
                  c.mount,
                  "the reference is not of the LiDAR: where the LiDAR sits in the frame it is of, "
                  "x,y,z,qx,qy,qz,qw [m] or newer-college-2020 (camera), newer-college-2021, "
                  "oxford-spires (base), hilti-2022 (handheld), hilti-2023-robot (IMU), nclt-hits "
                  "(body)")
      ->type_name("POSE")
      ->excludes("--kitti-calib");
}

void declare_pairing(CLI::App& command, EvalCommand& c) {
  CLI::Option* tolerance =
      command
          .add_option(
              "--tolerance",
              c.tolerance,
              "stamps farther apart are no pair [s] (0.01); without stamps, pairs go by index")
          ->type_name("S");
  command.add_option("--offset", c.offset, "added to the stamps of the estimates [s] (0)")
      ->type_name("S");
  CLI::Option* interpolate =
      command
          .add_flag("--interpolate",
                    c.interpolate,
                    "pair each pose with the other trajectory at its very instant, between two "
                    "poses, instead of the nearest one: the reference is interpolated, or the "
                    "estimate if the reference has less than half as many poses a second")
          ->excludes(tolerance);
  command
      .add_option(
          "--max-gap", c.max_gap, "nothing is interpolated between poses farther apart [s] (0.25)")
      ->type_name("S")
      ->needs(interpolate);
}

void declare_measures(CLI::App& command, EvalCommand& c) {
  command
      .add_option(
          "--align",
          c.align,
          "lay the estimate over the reference: se3 (rotation and translation), yaw "
          "(rotation about z and translation), first (the first poses coincide), none (se3)")
      ->type_name("HOW");
  command
      .add_option("--delta",
                  c.deltas,
                  "step of the relative error, with unit: 1f (frames), 10m, 0.5s; may be given "
                  "several times (1f 1s 10m)")
      ->type_name("STEP")
      ->allow_extra_args(false);
  command.add_flag("--all-pairs",
                   c.all_pairs,
                   "a relative error from every pose on, not only from the end of the one before");
  command
      .add_option("--segments",
                  c.segments,
                  "lengths for the KITTI error [m], with commas between (100,200,..,800; on ways "
                  "below 200 m 1,2,..,10; below 20 m 0.1,0.2,..,1)")
      ->type_name("M,M,...")
      ->delimiter(',')
      ->allow_extra_args(false);
}

}  // namespace

CLI::App& declare_eval(CLI::App& app, EvalCommand& c) {
  CLI::App& command = *app.add_subcommand(
      "eval", "Compare trajectories with a reference: ATE, RPE and the KITTI error");
  declare_inputs(command, c);
  declare_pairing(command, c);
  declare_measures(command, c);
  command.add_option("--json", c.json, "write all figures as JSON")->type_name("FILE");
  command.add_option("--csv", c.csv, "write all figures as a table, one a line")->type_name("FILE");
  command.add_option("--plot", c.plot, "write a PNG: top view, and error over distance")
      ->type_name("FILE");
  return command;
}

}  // namespace kissmap
