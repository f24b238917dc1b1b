// SPDX-License-Identifier: MIT
#include "formats/session/manifest_fields.hpp"

#include <cmath>
#include <limits>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

// nlohmann::json converts numbers silently; a manifest must hold what it is read as.
void require_kind(bool holds, const char* name, const char* kind, const json& object) {
  if (holds) return;
  throw json::type_error::create(302, std::string(name) + " is not " + kind, &object);
}

ordered_json read_options_to_json(const ReadOptions& options) {
  return {{"kitti_elevation_correction", options.kitti_elevation_correction},
          {"time_field", options.time_field},
          {"time_unit", options.time_unit},
          {"bin_columns", options.bin_columns},
          {"topic", options.topic},
          {"calibration", options.calibration}};
}

ReadOptions read_options_from_json(const json& object) {
  ReadOptions options;
  options.kitti_elevation_correction = bool_field(object, "kitti_elevation_correction");
  options.time_field = string_field(object, "time_field");
  options.time_unit = string_field(object, "time_unit");
  const std::uint64_t columns = unsigned_field(object, "bin_columns");
  require_kind(columns <= std::numeric_limits<int>::max(), "bin_columns", "a count", object);
  options.bin_columns = static_cast<int>(columns);
  // Sessions made before bags were read have neither.
  if (object.contains("topic")) options.topic = string_field(object, "topic");
  if (object.contains("calibration")) options.calibration = string_field(object, "calibration");
  return options;
}

ordered_json selection_to_json(const ScanSelection& selection) {
  return {{"first", selection.first},
          {"last", selection.last ? ordered_json(*selection.last) : ordered_json()},
          {"every", selection.every}};
}

ScanSelection selection_from_json(const json& object) {
  ScanSelection selection;
  selection.first = unsigned_field(object, "first");
  if (!object.at("last").is_null()) selection.last = unsigned_field(object, "last");
  selection.every = unsigned_field(object, "every");
  return selection;
}

ordered_json dropped_to_json(const DroppedReturns& dropped) {
  return {{"non_finite", dropped.non_finite},
          {"zero", dropped.zero},
          {"implausible", dropped.implausible}};
}

DroppedReturns dropped_from_json(const json& object) {
  return {unsigned_field(object, "non_finite"),
          unsigned_field(object, "zero"),
          unsigned_field(object, "implausible")};
}

}  // namespace

std::uint64_t unsigned_field(const json& object, const char* name) {
  const json& value = object.at(name);
  require_kind(value.is_number_unsigned(), name, "a whole number from 0", object);
  return value.get<std::uint64_t>();
}

double number_field(const json& object, const char* name) {
  const json& value = object.at(name);
  require_kind(value.is_number(), name, "a number", object);
  return value.get<double>();
}

bool bool_field(const json& object, const char* name) {
  const json& value = object.at(name);
  require_kind(value.is_boolean(), name, "true or false", object);
  return value.get<bool>();
}

std::string string_field(const json& object, const char* name) {
  const json& value = object.at(name);
  require_kind(value.is_string(), name, "a text", object);
  return value.get<std::string>();
}

double finite(double value, const char* name) {
  if (std::isfinite(value)) return value;
  throw Error(Fault::internal, std::string(name) + " of a session is not finite");
}

ordered_json log_to_json(const LogIdentity& log) {
  ordered_json files = ordered_json::array();
  for (const LogFile& file : log.files) {
    files.push_back({{"name", file.name}, {"size_bytes", file.size_bytes}, {"xxh3", file.xxh3}});
  }
  return {{"path", log.path.string()},
          {"format", log.format},
          {"stamp_source", log.stamp_source},
          {"read_options", read_options_to_json(log.read_options)},
          {"selection", selection_to_json(log.selection)},
          {"files", std::move(files)}};
}

LogIdentity log_from_json(const json& object) {
  LogIdentity log;
  log.path = string_field(object, "path");
  log.format = string_field(object, "format");
  log.stamp_source = string_field(object, "stamp_source");
  log.read_options = read_options_from_json(object.at("read_options"));
  log.selection = selection_from_json(object.at("selection"));
  for (const json& file : object.at("files")) {
    log.files.push_back({string_field(file, "name"),
                         unsigned_field(file, "size_bytes"),
                         string_field(file, "xxh3")});
  }
  return log;
}

ordered_json counts_to_json(const SessionCounts& counts) {
  ordered_json refused = ordered_json::object();
  for (const auto& [reason, refusals] : counts.scans_refused) {
    refused[reason] = {{"count", refusals.count}, {"examples", refusals.examples}};
  }
  ordered_json gaps = ordered_json::array();
  for (const StampGap& gap : counts.gaps) {
    gaps.push_back({{"log_index", gap.log_index}, {"seconds", finite(gap.seconds, "a gap")}});
  }
  return {{"scans_read", counts.scans_read},
          {"scans_used", counts.scans_used},
          {"scans_refused", std::move(refused)},
          {"scans_not_converged", counts.scans_not_converged},
          {"points_read", counts.points_read},
          {"points_out_of_range", counts.points_out_of_range},
          {"points_dropped", dropped_to_json(counts.points_dropped)},
          {"gaps", std::move(gaps)}};
}

SessionCounts counts_from_json(const json& object) {
  SessionCounts counts;
  counts.scans_read = unsigned_field(object, "scans_read");
  counts.scans_used = unsigned_field(object, "scans_used");
  for (const auto& [reason, refusals] : object.at("scans_refused").items()) {
    counts.scans_refused[reason] = {unsigned_field(refusals, "count"),
                                    refusals.at("examples").get<std::vector<std::string>>()};
  }
  counts.scans_not_converged = unsigned_field(object, "scans_not_converged");
  counts.points_read = unsigned_field(object, "points_read");
  counts.points_out_of_range = unsigned_field(object, "points_out_of_range");
  counts.points_dropped = dropped_from_json(object.at("points_dropped"));
  for (const json& gap : object.at("gaps")) {
    counts.gaps.push_back({unsigned_field(gap, "log_index"), number_field(gap, "seconds")});
  }
  return counts;
}

ordered_json pack_to_json(const PackSummary& pack) {
  return {{"bytes", pack.bytes},
          {"points", pack.points},
          {"resolution", finite(pack.resolution, "pack resolution")}};
}

PackSummary pack_from_json(const json& object) {
  PackSummary pack;
  pack.bytes = unsigned_field(object, "bytes");
  pack.points = unsigned_field(object, "points");
  pack.resolution = number_field(object, "resolution");
  return pack;
}

}  // namespace kissmap
