// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "kissmap/evaluation/evaluation.hpp"
#include "kissmap/formats/pictures.hpp"

namespace kissmap {

/// A trajectory as it was read, before any pairing.
struct TrajectorySummary {
  std::string name;    ///< path as the user gave it
  std::string format;  ///< see trajectory_file.hpp
  std::size_t poses = 0;
  std::size_t repeated = 0;  ///< poses with the stamp of the one before
  double path_length = 0.0;  ///< m
};

struct EvaluatedTrajectory {
  TrajectorySummary about;
  Evaluation evaluation;
};

/// Estimates side by side against one reference.
struct EvaluationReport {
  TrajectorySummary reference;
  std::vector<Rigid3> reference_poses;
  EvaluationOptions options;
  std::vector<EvaluatedTrajectory> estimates;
};

/// "se3", "yaw", "first" or "none".
std::string to_string(MapAlignment alignment);

/// "neither", "reference" or "estimate".
std::string to_string(PosePairs::Side side);

/// "1 frame", "0.5 s", "10 m".
std::string to_string(const Delta& delta);

/// All figures and options; lengths in m, angles in degrees, errors of segments in % and deg/m. A
/// figure that rests on no pair is null. Numbers read back exactly.
std::string evaluation_json(const EvaluationReport& report);

/// One line a figure: trajectory,metric,over,quantity,unit,count,rmse,mean,median,std,min,max with
/// empty fields where a statistic does not exist. Texts are quoted where they need it (RFC 4180).
std::string evaluation_csv(const EvaluationReport& report);

/// Top view of all trajectories after alignment, along the two axes in which the reference is
/// widest, and the error of each position over the distance along the reference.
Picture draw_evaluation(const EvaluationReport& report);

/// Writes text aside, then renames. Throws Error(output).
void write_text_file(const std::filesystem::path& path, const std::string& text);

}  // namespace kissmap
