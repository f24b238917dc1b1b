// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>

namespace kissmap {

/// Declares what all that is made of a session takes: --log, --threads and --quiet.
template <typename Command>
void declare_how_computed(CLI::App& command, Command& c) {
  command.add_option("--log", c.log, "where the log is now, if it moved")->type_name("PATH");
  command
      .add_option("--threads",
                  c.threads,
                  "threads for computing (0: one a processor); the result is the same for any")
      ->type_name("N")
      ->check(CLI::Range(0, 1024));
  command.add_flag("--quiet", c.quiet, "print errors only");
}

/// Declares --frame.
template <typename Command>
void declare_frame(CLI::App& command, Command& c) {
  command
      .add_option("--frame",
                  c.frame,
                  "level: upright, z = 0 on the ground where the first local map lies, as "
                  "export-grid; map: that of trajectory.tum (level)")
      ->type_name("level|map")
      ->check(CLI::IsMember({"level", "map"}));
}

/// Declares --max-memory.
template <typename Command>
void declare_max_memory(CLI::App& command, Command& c) {
  command
      .add_option("--max-memory",
                  c.max_memory,
                  "memory of the voxels that rays are cast into [GB]; a larger map is made in "
                  "parts, each from a pass over the log, and is the same in the end (4)")
      ->type_name("GB");
}

/// Declares --no-return-range.
template <typename Command>
void declare_no_return_range(CLI::App& command, Command& c) {
  command
      .add_option("--no-return-range",
                  c.no_return_range,
                  "rays of which nothing came back are free up to here, where the log tells them "
                  "(packets of sensors) [m]; black paint, glass and what is too near swallow rays, "
                  "too (0: they say nothing)")
      ->type_name("M");
}

/// Declares what every export takes, however it is made: that, and --overwrite.
template <typename Command>
void declare_how(CLI::App& command, Command& c, const char* what_is_replaced) {
  declare_how_computed(command, c);
  command.add_flag("--overwrite", c.overwrite, what_is_replaced);
}

}  // namespace kissmap
