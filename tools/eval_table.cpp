// SPDX-License-Identifier: MIT
#include "eval_table.hpp"

#include <functional>
#include <numbers>
#include <optional>

#include "report.hpp"

namespace kissmap {
namespace {

constexpr double degrees = 180.0 / std::numbers::pi;

using Figure = std::function<std::optional<double>(const Evaluation&)>;

std::string row(const EvaluationReport& report,
                const std::string& label,
                const char* unit,
                const char* statistic,
                const Figure& figure) {
  std::string line = text("%-22s %-6s %-6s", label.c_str(), unit, statistic);
  for (const EvaluatedTrajectory& estimate : report.estimates) {
    const auto value = figure(estimate.evaluation);
    line += value ? text(" %13.6f", *value) : text(" %13s", "-");
  }
  return line + "\n";
}

using Choose = std::function<const ErrorStatistics&(const Evaluation&)>;

std::string statistics_rows(const EvaluationReport& report,
                            const std::string& label,
                            const char* unit,
                            double scale,
                            const Choose& choose) {
  constexpr std::pair<const char*, double ErrorStatistics::*> shown[] = {
      {"rmse", &ErrorStatistics::rmse},
      {"mean", &ErrorStatistics::mean},
      {"median", &ErrorStatistics::median},
      {"max", &ErrorStatistics::max}};
  std::string lines;
  for (const auto& [name, member] : shown) {
    const bool first = lines.empty();
    lines += row(report,
                 first ? label : "",
                 first ? unit : "",
                 name,
                 [&, value = member](const Evaluation& e) -> std::optional<double> {
                   const ErrorStatistics& s = choose(e);
                   if (s.count == 0) return std::nullopt;
                   return scale * s.*value;
                 });
  }
  return lines;
}

std::string relative_rows(const EvaluationReport& report, std::size_t i) {
  const std::string over = "RPE over " + to_string(report.options.deltas[i]);
  return statistics_rows(report,
                         over,
                         "m",
                         1.0,
                         [i](const Evaluation& e) -> const ErrorStatistics& {
                           return e.relative[i].translation;
                         }) +
         statistics_rows(
             report, over, "deg", degrees, [i](const Evaluation& e) -> const ErrorStatistics& {
               return e.relative[i].rotation;
             });
}

std::string kitti_rows(const EvaluationReport& report) {
  const auto& lengths = report.options.kitti.lengths;
  const std::string label = text("KITTI %g..%g m", lengths.front(), lengths.back());
  const auto mean = [](double KittiMean::*value, double scale) -> Figure {
    return [=](const Evaluation& e) -> std::optional<double> {
      if (e.kitti.overall.segments == 0) return std::nullopt;
      return scale * e.kitti.overall.*value;
    };
  };
  return row(report, label, "%", "mean", mean(&KittiMean::translation, 100.0)) +
         row(report, "", "deg/m", "mean", mean(&KittiMean::rotation, degrees));
}

std::string heading(const EvaluationReport& report) {
  const auto about = [](const TrajectorySummary& t) {
    std::string line = text("%s (%s, %s poses, %.3f m)\n",
                            printable(t.name).c_str(),
                            t.format.c_str(),
                            with_commas(t.poses).c_str(),
                            t.path_length);
    if (t.repeated > 0) {
      line += text("           take care: %s with the stamp of the pose before\n",
                   with_commas(t.repeated).c_str());
    }
    return line;
  };
  std::string lines = "reference  " + about(report.reference);
  for (std::size_t i = 0; i < report.estimates.size(); ++i) {
    const Evaluation& e = report.estimates[i].evaluation;
    lines += text("%9zu  ", i + 1) + about(report.estimates[i].about);
    lines += text("           %s pairs by %s",
                  with_commas(e.pairs.size()).c_str(),
                  e.pairs.by_stamp ? "stamp" : "index");
    if (e.pairs.interpolated != PosePairs::Side::neither) {
      lines += text(", %s interpolated,", to_string(e.pairs.interpolated).c_str());
    }
    lines += text(" over %.3f m\n", e.distances.empty() ? 0.0 : e.distances.back());
  }
  lines += "aligned    " + to_string(report.options.alignment) + "\n\n";
  lines += text("%-22s %-6s %-6s", "", "", "");
  for (std::size_t i = 0; i < report.estimates.size(); ++i) lines += text(" %13zu", i + 1);
  return lines + "\n";
}

}  // namespace

std::string evaluation_table(const EvaluationReport& report) {
  const auto translation = [](const Evaluation& e) -> const ErrorStatistics& {
    return e.absolute_translation;
  };
  const auto rotation = [](const Evaluation& e) -> const ErrorStatistics& {
    return e.absolute_rotation;
  };
  std::string table = heading(report);
  table += statistics_rows(report, "ATE", "m", 1.0, translation);
  table += statistics_rows(report, "ATE", "deg", degrees, rotation);
  for (std::size_t i = 0; i < report.options.deltas.size(); ++i) table += relative_rows(report, i);
  return table + kitti_rows(report);
}

}  // namespace kissmap
