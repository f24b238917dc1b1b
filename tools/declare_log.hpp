// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// CLI11 lets -1 pass for a huge unsigned number.
inline CLI::Validator whole_number() {
  return {[](const std::string& text) -> std::string {
            const bool digits = text.find_first_not_of("0123456789") == std::string::npos;
            return digits && text.size() < 16 ? "" : text + " is not a whole number from 0";
          },
          ""};
}

/// Declares --format, --topic and --calibration, for commands without a configuration.
inline void declare_log(CLI::App& command, std::string& format, ReadOptions& options) {
  command.add_option("--format", format, "format of the log (default: found by looking at it)")
      ->type_name("NAME");
  command
      .add_option("--topic",
                  options.topic,
                  "topic of a bag or MCAP file, port of a capture, scene of nuScenes (the only one "
                  "there is)")
      ->type_name("NAME");
  command
      .add_option("--calibration",
                  options.calibration,
                  "what came with the sensor whose packets are recorded: a Hesai's angles (.csv), "
                  "the ROS driver's file of an HDL-64E (.yaml), an Ouster's metadata (.json; found "
                  "beside a capture)")
      ->type_name("FILE");
}

/// Declares --first, --last and --every.
inline void declare_selection(CLI::App& command, ScanSelection& selection) {
  command.add_option("--first", selection.first, "index of the first scan to use, from 0 (0)")
      ->type_name("I")
      ->check(whole_number());
  command.add_option("--last", selection.last, "index of the last scan to use (end of the log)")
      ->type_name("I")
      ->check(whole_number());
  command.add_option("--every", selection.every, "use every Nth scan (1)")
      ->type_name("N")
      ->check(whole_number());
}

}  // namespace kissmap
