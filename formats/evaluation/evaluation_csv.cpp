// SPDX-License-Identifier: MIT
#include <numbers>

#include "formats/files/table.hpp"
#include "kissmap/formats/evaluation_report.hpp"

namespace kissmap {
namespace {

constexpr double degrees = 180.0 / std::numbers::pi;

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

void append_row(std::string& csv,
                const std::string& begin,
                const ErrorStatistics& s,
                double scale) {
  csv += begin;
  append_number(csv, std::uint64_t{s.count});
  for (const double value : {s.rmse, s.mean, s.median, s.std, s.min, s.max}) {
    csv += ',';
    if (s.count > 0) append_number(csv, scale * value);
  }
  csv += '\n';
}

void append_mean(std::string& csv, const std::string& begin, std::size_t count, double mean) {
  csv += begin;
  append_number(csv, std::uint64_t{count});
  csv += ",,";
  if (count > 0) append_number(csv, mean);
  csv += ",,,,\n";
}

void append_kitti(std::string& csv,
                  const std::string& name,
                  const std::string& over,
                  const KittiMean& mean) {
  const std::string begin = name + ",kitti," + over;
  append_mean(csv, begin + ",translation,%,", mean.segments, 100.0 * mean.translation);
  append_mean(csv, begin + ",rotation,deg/m,", mean.segments, degrees * mean.rotation);
}

std::string length_text(double metres) {
  std::string text;
  append_number(text, metres);
  return text + " m";
}

}  // namespace

std::string evaluation_csv(const EvaluationReport& report) {
  std::string csv = "trajectory,metric,over,quantity,unit,count,rmse,mean,median,std,min,max\n";
  for (const EvaluatedTrajectory& estimate : report.estimates) {
    const std::string name = quoted(estimate.about.name);
    const Evaluation& e = estimate.evaluation;
    append_row(csv, name + ",ate,,translation,m,", e.absolute_translation, 1.0);
    append_row(csv, name + ",ate,,rotation,deg,", e.absolute_rotation, degrees);
    for (const RelativeError& relative : e.relative) {
      const std::string begin = name + ",rpe," + to_string(relative.delta);
      append_row(csv, begin + ",translation,m,", relative.translation, 1.0);
      append_row(csv, begin + ",rotation,deg,", relative.rotation, degrees);
    }
    append_kitti(csv, name, "all", e.kitti.overall);
    for (const KittiMean& mean : e.kitti.lengths) {
      append_kitti(csv, name, length_text(mean.length), mean);
    }
  }
  return csv;
}

}  // namespace kissmap
