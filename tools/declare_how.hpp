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

/// Declares what every export takes, however it is made: that, and --overwrite.
template <typename Command>
void declare_how(CLI::App& command, Command& c, const char* what_is_replaced) {
  declare_how_computed(command, c);
  command.add_flag("--overwrite", c.overwrite, what_is_replaced);
}

}  // namespace kissmap
