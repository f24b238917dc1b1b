// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>

#include "commands.hpp"
#include "eval_table.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/evaluation_report.hpp"
#include "kissmap/formats/trajectory_file.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

double number(const std::string& text, const std::string& flag) {
  std::size_t used = 0;
  double value = 0.0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != text.size()) {
    throw usage_error(flag + ": " + text + " is not a number");
  }
  return value;
}

Delta delta_from(const std::string& text) {
  Delta delta;
  switch (text.empty() ? '\0' : text.back()) {
    case 'f':
      delta.unit = DeltaUnit::frames;
      break;
    case 'm':
      delta.unit = DeltaUnit::metres;
      break;
    case 's':
      delta.unit = DeltaUnit::seconds;
      break;
    default:
      throw usage_error("--delta: " + text + " needs a unit: 1f (frames), 10m or 0.5s");
  }
  delta.value = number(text.substr(0, text.size() - 1), "--delta");
  return delta;
}

MapAlignment alignment_from(const std::string& name) {
  for (const MapAlignment a :
       {MapAlignment::se3, MapAlignment::yaw, MapAlignment::first, MapAlignment::none}) {
    if (to_string(a) == name) return a;
  }
  throw usage_error("--align: " + name + " is none of se3, yaw, first, none");
}

EvaluationOptions options_of(const EvalCommand& command) {
  EvaluationOptions options;
  options.association = {command.tolerance, command.offset, command.interpolate, command.max_gap};
  options.alignment = alignment_from(command.align);
  options.pairs = command.all_pairs ? PairChoice::all : PairChoice::consecutive;
  if (!command.deltas.empty()) options.deltas.clear();
  for (const std::string& text : command.deltas) options.deltas.push_back(delta_from(text));
  if (!command.segments.empty()) options.kitti.lengths = command.segments;
  require_valid(options);
  return options;
}

/// A slip of the hand must not cost a trajectory.
void require_apart(const EvalCommand& command) {
  std::vector<fs::path> taken = command.estimates;
  taken.push_back(command.reference);
  if (!command.times.empty()) taken.push_back(command.times);
  if (!command.calibration.empty()) taken.push_back(command.calibration);
  for (const fs::path& output : {command.json, command.csv, command.plot}) {
    if (output.empty()) continue;
    for (const fs::path& other : taken) {
      std::error_code absent;
      if (output == other || fs::equivalent(output, other, absent)) {
        throw usage_error(output.string() + " is named twice; write to a file of its own");
      }
    }
    taken.push_back(output);
  }
}

TrajectorySummary summary_of(const fs::path& path, const TrajectoryFile& file) {
  const auto distances = distances_along(file.trajectory.poses);
  return {path.string(), file.format, file.trajectory.size(), file.repeated, distances.back()};
}

/// The error of one trajectory gets its name.
template <typename Call>
auto naming(const fs::path& path, const Call& call) {
  try {
    return call();
  } catch (const Error& error) {
    if (error.fault() != Fault::input) throw;
    throw input_error(path, error.what());
  }
}

/// Where the LiDAR sits in the frame whose poses the reference holds.
std::optional<Rigid3> reference_from_lidar(const EvalCommand& command) {
  if (!command.calibration.empty()) return read_kitti_calibration(command.calibration);
  if (!command.mount.empty()) return mount_from(command.mount);
  return std::nullopt;
}

/// All estimates are paired before any is judged: the segments have to be the same for all.
EvaluationReport evaluate_all(const EvalCommand& command) {
  EvaluationReport report;
  report.options = options_of(command);
  const TrajectoryFile reference = read_trajectory(command.reference, command.times, command.topic);
  report.reference = summary_of(command.reference, reference);
  report.reference_poses = reference.trajectory.poses;
  const std::optional<Rigid3> mount = reference_from_lidar(command);
  std::vector<PosePairs> pairs;
  double longest = 0.0;
  for (const fs::path& path : command.estimates) {
    TrajectoryFile file = read_trajectory(path, command.times);
    report.estimates.push_back({summary_of(path, file), {}});
    if (mount) {
      for (Rigid3& pose : file.trajectory.poses) pose = pose * mount->inverse();
    }
    pairs.push_back(naming(path, [&] {
      return associate(reference.trajectory, file.trajectory, report.options.association);
    }));
    longest = std::max(longest, distances_along(pairs.back().reference).back());
  }
  if (command.segments.empty()) report.options.kitti.lengths = kitti_lengths_for(longest);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    report.estimates[i].evaluation =
        naming(command.estimates[i], [&] { return evaluate(std::move(pairs[i]), report.options); });
  }
  return report;
}

}  // namespace

void eval(const EvalCommand& command) {
  require_apart(command);
  const EvaluationReport report = evaluate_all(command);
  std::fputs(evaluation_table(report).c_str(), stdout);
  if (!command.json.empty()) write_text_file(command.json, evaluation_json(report));
  if (!command.csv.empty()) write_text_file(command.csv, evaluation_csv(report));
  if (!command.plot.empty()) write_png(draw_evaluation(report), command.plot);
}

}  // namespace kissmap
