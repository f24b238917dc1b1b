// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>
#include <numbers>

#include "kissmap/formats/evaluation_report.hpp"
#include "kissmap/version.hpp"

namespace kissmap {
namespace {

using Json = nlohmann::ordered_json;

constexpr double degrees = 180.0 / std::numbers::pi;

Json statistics_json(const ErrorStatistics& s, double scale) {
  Json json;
  json["count"] = s.count;
  const std::pair<const char*, double> values[] = {{"rmse", s.rmse},
                                                   {"mean", s.mean},
                                                   {"median", s.median},
                                                   {"std", s.std},
                                                   {"min", s.min},
                                                   {"max", s.max}};
  for (const auto& [name, value] : values) {
    json[name] = s.count > 0 ? Json(scale * value) : Json(nullptr);
  }
  return json;
}

Json pose_error_json(const ErrorStatistics& translation, const ErrorStatistics& rotation) {
  return {{"translation_m", statistics_json(translation, 1.0)},
          {"rotation_deg", statistics_json(rotation, degrees)}};
}

Json kitti_mean_json(const KittiMean& mean) {
  Json json;
  if (mean.length > 0.0) json["length_m"] = mean.length;
  json["segments"] = mean.segments;
  const bool known = mean.segments > 0;
  json["translation_percent"] = known ? Json(100.0 * mean.translation) : Json(nullptr);
  json["rotation_deg_per_m"] = known ? Json(degrees * mean.rotation) : Json(nullptr);
  return json;
}

Json kitti_json(const KittiError& kitti) {
  Json json = kitti_mean_json(kitti.overall);
  json["lengths"] = Json::array();
  for (const KittiMean& mean : kitti.lengths) json["lengths"].push_back(kitti_mean_json(mean));
  return json;
}

Json pose_json(const Rigid3& pose) {
  const auto& t = pose.translation;
  const auto& q = pose.rotation;
  return {{"translation_m", {t.x(), t.y(), t.z()}},
          {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

Json summary_json(const TrajectorySummary& about) {
  return {{"name", about.name},
          {"format", about.format},
          {"poses", about.poses},
          {"poses_with_repeated_stamp", about.repeated},
          {"path_length_m", about.path_length}};
}

Json estimate_json(const EvaluatedTrajectory& estimate) {
  const Evaluation& e = estimate.evaluation;
  Json json = summary_json(estimate.about);
  json["pairs"] = e.pairs.size();
  json["paired_by"] = e.pairs.by_stamp ? "stamp" : "index";
  json["interpolated"] = to_string(e.pairs.interpolated);
  json["reference_length_m"] = e.distances.empty() ? 0.0 : e.distances.back();
  json["reference_from_map"] = pose_json(e.reference_from_map);
  json["ate"] = pose_error_json(e.absolute_translation, e.absolute_rotation);
  json["rpe"] = Json::array();
  for (const RelativeError& relative : e.relative) {
    Json entry = {{"delta", to_string(relative.delta)}};
    entry.update(pose_error_json(relative.translation, relative.rotation));
    json["rpe"].push_back(entry);
  }
  json["kitti"] = kitti_json(e.kitti);
  return json;
}

}  // namespace

std::string evaluation_json(const EvaluationReport& report) {
  const EvaluationOptions& options = report.options;
  Json json;
  json["program_version"] = version();
  json["reference"] = summary_json(report.reference);
  json["options"] = {
      {"tolerance_s", options.association.tolerance},
      {"offset_s", options.association.offset},
      {"interpolate", options.association.interpolate},
      {"max_gap_s", options.association.max_gap},
      {"align", to_string(options.alignment)},
      {"pairs", options.pairs == PairChoice::all ? "all" : "consecutive"},
      {"kitti_step_poses", options.kitti.step},
  };
  json["estimates"] = Json::array();
  for (const EvaluatedTrajectory& estimate : report.estimates) {
    json["estimates"].push_back(estimate_json(estimate));
  }
  // Names may hold any bytes; what is not UTF-8 is replaced instead of refused.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace kissmap
