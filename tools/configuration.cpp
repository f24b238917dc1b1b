// SPDX-License-Identifier: MIT
#include "configuration.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

std::string flag_of(std::string key) {
  std::ranges::replace(key, '_', '-');
  return "--" + key;
}

template <typename Number>
std::string shortest(Number value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, std::end(buffer), value).ptr};
}

// "100" would be an integer in TOML.
std::string toml_double(double value) {
  const std::string text = shortest(value);
  return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
}

std::string toml_value(const Setting& setting) {
  return std::visit(Overloaded{[](const double* v) { return toml_double(*v); },
                               [](const int* v) { return shortest(*v); },
                               [](const bool* v) { return std::string(*v ? "true" : "false"); },
                               [](const std::string* v) { return '"' + *v + '"'; }},
                    setting.value);
}

template <typename Number>
bool parse_number(const std::string& text, Number& value) {
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && rest == end;
}

bool parse_bool(const std::string& text, bool& value) {
  value = text == "true";
  return value || text == "false";
}

// `where` begins the error: a flag, or file and line.
void set(const Setting& setting, const std::string& text, const std::string& where) {
  const char* wanted = nullptr;
  std::visit(
      Overloaded{[&](double* v) { wanted = parse_number(text, *v) ? nullptr : "a number"; },
                 [&](int* v) { wanted = parse_number(text, *v) ? nullptr : "a whole number"; },
                 [&](bool* v) { wanted = parse_bool(text, *v) ? nullptr : "true or false"; },
                 [&](std::string* v) { *v = text; }},
      setting.value);
  if (wanted == nullptr) return;
  throw usage_error(where + ": " + setting.key + " = '" + text + "' is not " + wanted);
}

const Setting* find(const std::vector<Setting>& all, const std::string& key) {
  const auto found = std::ranges::find_if(all, [&](const Setting& s) { return key == s.key; });
  return found == all.end() ? nullptr : &*found;
}

std::string keys_of(const std::vector<Setting>& all) {
  std::string keys;
  for (const Setting& setting : all) keys += std::string(keys.empty() ? "" : ", ") + setting.key;
  return keys;
}

// CLI11 does not tell lines, so look for the one that sets the key.
std::string place(const std::filesystem::path& file,
                  const std::string& text,
                  const std::string& key) {
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::size_t begin = line.find_first_not_of(" \t\"'");
    if (begin != std::string::npos && line.compare(begin, key.size(), key) == 0) {
      return file.string() + ":" + std::to_string(number);
    }
  }
  return file.string();
}

std::vector<Setting> log_settings(ReadOptions& log) {
  return {
      {"log",
       "kitti_elevation_correction",
       "",
       "raise the points of KITTI odometry logs by 0.205 degrees, undoing an error of their "
       "calibration; no effect on other formats",
       &log.kitti_elevation_correction},
      {"log",
       "time_field",
       "",
       "name of the per-point time field; empty: found by rule",
       &log.time_field},
      {"log",
       "time_unit",
       "",
       "unit of that field: s, ms, us, ns, or none to ignore it; empty: found by rule",
       &log.time_unit},
      {"log",
       "bin_columns",
       "",
       "float32 columns of headerless .bin files; 0: found by rule",
       &log.bin_columns},
      {"log",
       "topic",
       "",
       "topic of a bag or MCAP file, port of a capture, scene of nuScenes; empty: the only one "
       "there is",
       &log.topic},
      {"log",
       "calibration",
       "",
       "file that came with the sensor whose packets are recorded: a Hesai's angles (.csv), the "
       "ROS driver's file of an HDL-64E (.yaml), an Ouster's metadata (.json); empty: none, or "
       "found beside the capture",
       &log.calibration},
  };
}

std::vector<Setting> odometry_settings(OdometryOptions& odometry) {
  return {
      {"odometry", "max_range", "m", "farther points are dropped", &odometry.max_range},
      {"odometry", "min_range", "m", "nearer points are dropped", &odometry.min_range},
      {"odometry",
       "voxel_size",
       "m",
       "of the odometry's map; 0: max_range / 100, half or a quarter of it in narrow places",
       &odometry.voxel_size},
      {"odometry",
       "deskew",
       "",
       "undo the motion inside a sweep where points have times",
       &odometry.deskew},
      {"odometry",
       "max_points_per_voxel",
       "",
       "of the odometry's map",
       &odometry.max_points_per_voxel},
      {"odometry",
       "initial_threshold",
       "m",
       "expected error of the motion model before any scan",
       &odometry.initial_threshold},
      {"odometry",
       "min_motion",
       "m",
       "smaller errors of the motion model do not count",
       &odometry.min_motion},
      {"odometry",
       "max_iterations",
       "",
       "of the registration of one scan",
       &odometry.registration.max_iterations},
      {"odometry",
       "min_update",
       "m, rad",
       "a smaller step ends the registration of a scan",
       &odometry.registration.min_update},
  };
}

std::vector<Setting> local_map_settings(LocalMapOptions& local_maps) {
  return {
      {"local_maps",
       "local_map_voxel_size",
       "m",
       "of the grid of a local map",
       &local_maps.voxel_size},
      {"local_maps",
       "local_map_points_per_voxel",
       "",
       "of the grid of a local map",
       &local_maps.max_points_per_voxel},
      {"local_maps",
       "splitting_distance",
       "m",
       "longest distance from its keypose at which a local map is closed",
       &local_maps.splitting_distance},
  };
}

std::vector<Setting> loop_closing_settings(LoopClosingOptions& loops) {
  return {
      {"loop_closing",
       "loop_closing",
       "",
       "find places seen before and correct the trajectory",
       &loops.enabled},
      {"loop_closing",
       "second_look",
       "",
       "after the last scan, look again along the corrected trajectory",
       &loops.second_look},
      {"loop_closing",
       "max_descriptor_distance",
       "",
       "bits between matched image descriptors, of 256",
       &loops.search.max_distance},
      {"loop_closing",
       "min_inliers",
       "",
       "matches that must agree on a motion",
       &loops.search.min_inliers},
      {"loop_closing",
       "skipped_local_maps",
       "",
       "local maps just before the latest that are no candidates",
       &loops.search.skipped_latest},
      {"loop_closing",
       "max_candidates",
       "",
       "best candidates of a local map that are registered in 3D",
       &loops.search.max_candidates},
      {"loop_closing",
       "min_overlap",
       "",
       "share of the smaller local map's voxels that both must hold",
       &loops.validation.min_overlap},
      {"loop_closing",
       "min_wall_agreement",
       "",
       "share of steep surfaces near each other that must coincide",
       &loops.validation.min_wall_agreement},
      {"loop_closing",
       "min_observability",
       "",
       "least share of the surfaces that must bind any direction",
       &loops.validation.min_observability},
  };
}

std::string unknown_key(const std::string& where,
                        const std::string& section,
                        const std::string& key,
                        const Setting* elsewhere,
                        const std::vector<Setting>& all) {
  std::string message = where + ": unknown key '";
  if (!section.empty()) message.append(section).append(".");
  message.append(key).append("'; ");
  if (elsewhere == nullptr) return message.append("known are ").append(keys_of(all));
  return message.append("it belongs under [").append(elsewhere->section).append("]");
}

}  // namespace

void require_valid(const Configuration& configuration) {
  require_valid(configuration.log);
  require_valid(configuration.odometry);
  require_valid(configuration.local_maps);
  require_valid(configuration.loop_closing);
}

std::vector<Setting> settings(Configuration& configuration) {
  std::vector<Setting> all = log_settings(configuration.log);
  std::ranges::copy(odometry_settings(configuration.odometry), std::back_inserter(all));
  std::ranges::copy(local_map_settings(configuration.local_maps), std::back_inserter(all));
  std::ranges::copy(loop_closing_settings(configuration.loop_closing), std::back_inserter(all));
  return all;
}

std::string to_toml(Configuration configuration) {
  std::string text =
      "# kissmap configuration. Every key is also a flag: max_range is --max-range.\n";
  std::string section;
  for (const Setting& setting : settings(configuration)) {
    if (section != setting.section) {
      section = setting.section;
      text += "\n[" + section + "]\n";
    }
    const std::string unit = *setting.unit == '\0' ? "" : " [" + std::string(setting.unit) + "]";
    text += std::string(setting.key) + " = " + toml_value(setting) + "  # " + setting.meaning +
            unit + "\n";
  }
  return text;
}

void ConfigurationFlags::add_to(CLI::App& command) {
  command.add_option("--config", config_file_, "TOML file with settings; flags win over it")
      ->type_name("FILE");
  Configuration defaults;
  const std::vector<Setting> all = settings(defaults);
  given_.reserve(all.size());  // the options keep references
  for (const Setting& setting : all) {
    given_.emplace_back(setting.key, std::nullopt);
    std::string type = *setting.unit == '\0' ? "" : "[" + std::string(setting.unit) + "]";
    if (std::holds_alternative<bool*>(setting.value)) type = "true|false";
    command.add_option(flag_of(setting.key), given_.back().second, setting.meaning)
        ->type_name(type + " (" + toml_value(setting) + ")")
        ->group("Settings [" + std::string(setting.section) + "] (with default)");
  }
}

Configuration ConfigurationFlags::configuration() const {
  Configuration configuration;
  if (!config_file_.empty()) apply_file(config_file_, configuration);
  const std::vector<Setting> all = settings(configuration);
  for (const auto& [key, text] : given_) {
    if (text) set(*find(all, key), *text, flag_of(key));
  }
  require_valid(configuration);
  return configuration;
}

void apply_file(const std::filesystem::path& file, Configuration& configuration) {
  std::ifstream in(file);
  std::stringstream content;
  if (!in || !(content << in.rdbuf())) {
    throw usage_error(file.string() + ": cannot be read as a configuration");
  }
  std::istringstream toml(content.str());
  const std::vector<Setting> all = settings(configuration);
  for (const CLI::ConfigItem& item : CLI::ConfigTOML().from_config(toml)) {
    if (item.name == "++" || item.name == "--") continue;  // section marks of CLI11
    const std::string where = place(file, content.str(), item.name);
    const Setting* setting = find(all, item.name);
    const std::string section = item.parents.empty() ? "" : item.parents.front();
    if (setting == nullptr || section != setting->section) {
      throw usage_error(unknown_key(where, section, item.name, setting, all));
    }
    if (item.inputs.size() != 1) throw usage_error(where + ": " + item.name + " needs one value");
    set(*setting, item.inputs.front(), where);
  }
}

Configuration configuration_of_session(const std::filesystem::path& session) {
  Configuration configuration;
  apply_file(session / "config.toml", configuration);
  require_valid(configuration);
  return configuration;
}

}  // namespace kissmap
