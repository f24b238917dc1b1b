// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "configuration.hpp"
#include "kissmap/formats/scan_log.hpp"
#include "kissmap/graph/pose_graph.hpp"

namespace kissmap {

struct RunCommand {
  std::filesystem::path log;
  std::filesystem::path session;
  std::string format;
  ConfigurationFlags configuration;
  ScanSelection selection;
  int threads = 0;
  bool pack = false;
  bool overwrite = false;
  bool quiet = false;
};
void run(const RunCommand& command);

struct InfoCommand {
  std::filesystem::path path;
  std::string format;
  bool all = false;
};
void info(const InfoCommand& command);

struct PackCommand {
  std::filesystem::path session;
  std::filesystem::path log;
};
void pack(const PackCommand& command);

struct OptimizeCommand {
  std::filesystem::path input;
  std::filesystem::path output;
  std::filesystem::path edits;  ///< empty: none
  std::string start;            ///< "file", "tree", "chordal"; empty: what the input allows
  PoseGraphOptions options;
  bool drop_coupling = false;  ///< of edges with negative information
  bool overwrite = false;
};
void optimize(const OptimizeCommand& command);

void list_formats();
void print_default_configuration();

}  // namespace kissmap
