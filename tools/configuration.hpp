// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "kissmap/formats/scan_log.hpp"
#include "kissmap/loop_closing/loop_closer.hpp"
#include "kissmap/mapping/mapper.hpp"
#include "kissmap/odometry/odometry.hpp"

namespace CLI {
class App;
}

namespace kissmap {

/// All that decides a result. What only decides how it is computed (threads, progress) is not here.
struct Configuration {
  ReadOptions log;
  OdometryOptions odometry;
  LocalMapOptions local_maps;
  LoopClosingOptions loop_closing;
};
/// Throws Error(usage) naming the first value out of range.
void require_valid(const Configuration& configuration);

/// One value of a configuration: a key of the TOML file and a flag of the command line at once.
struct Setting {
  const char* section;
  const char* key;   ///< unique over all sections; the flag is --key with '-' for '_'
  const char* unit;  ///< empty for plain numbers, switches and names
  const char* meaning;
  std::variant<double*, int*, bool*, std::string*> value;
};

/// Every setting, bound to `configuration`, in the order of the file. The one place where keys,
/// flags, units and help are declared.
std::vector<Setting> settings(Configuration& configuration);

/// TOML text that read_configuration reads back to the same values.
std::string to_toml(Configuration configuration);

/// Values given as flags; apart from the configuration because flags win over the file.
class ConfigurationFlags {
 public:
  /// Declares --config and one flag a setting.
  void add_to(CLI::App& command);

  /// Defaults, then the file, then the flags. Throws Error(usage).
  Configuration configuration() const;

 private:
  std::string config_file_;
  std::vector<std::pair<std::string, std::optional<std::string>>> given_;  ///< key, text
};

/// Sets what a TOML file names. Throws Error(usage) naming file, line and key.
void apply_file(const std::filesystem::path& file, Configuration& configuration);

/// The configuration a session was made with. Throws Error naming its config.toml.
Configuration configuration_of_session(const std::filesystem::path& session);

}  // namespace kissmap
