// SPDX-License-Identifier: MIT
#include "info_closures.hpp"

#include <map>
#include <utility>
#include <vector>

#include "report.hpp"

namespace kissmap {
namespace {

bool is_closed(const Closure& closure) {
  return closure.verdict == ClosureVerdict::accepted;
}

/// Where each local map begins, by id: seconds since the first pose, or, of a log whose stamps only
/// count, the scan.
std::vector<std::string> beginnings(const Session& session, bool by_index) {
  std::vector<std::string> begins(session.local_maps.size());
  for (const SessionScan& scan : session.scans) {
    std::string& begin = begins[scan.mapped.local_map_id];
    if (!begin.empty()) continue;
    const std::int64_t since =
        scan.mapped.pose_stamp_ns - session.scans.front().mapped.pose_stamp_ns;
    begin =
        by_index ? std::to_string(scan.log_index) : text("%.1f", 1e-9 * static_cast<double>(since));
  }
  return begins;
}

std::string describe_reasons(const std::vector<Closure>& closures) {
  std::map<std::pair<bool, std::string>, std::uint64_t> counts;
  for (const Closure& closure : closures) ++counts[{!is_closed(closure), reason(closure)}];
  std::string lines;
  for (const auto& [key, count] : counts) {
    lines += text("    %-10s%s: %s\n",
                  key.first ? "refused" : "closed",
                  with_commas(count).c_str(),
                  key.second.c_str());
  }
  return lines;
}

std::string closure_line(const Closure& closure, const std::vector<std::string>& begins) {
  return text("    %6u %9u %10s %10s %7d %8.2f %9.3f%s\n",
              closure.query_id,
              closure.reference_id,
              begins[closure.query_id].c_str(),
              begins[closure.reference_id].c_str(),
              closure.inliers,
              closure.overlap,
              closure.residual_after,
              reason(closure) == "accepted" ? "" : ("  " + reason(closure)).c_str());
}

}  // namespace

std::string describe_closures(const Session& session, std::size_t most) {
  if (!session.corrected) return "  loops       left open\n";
  std::string lines = describe_loops(session.closures) + describe_reasons(session.closures);
  const bool by_index = session.manifest.log.stamp_source == "index";
  const std::vector<std::string> begins = beginnings(session, by_index);
  std::size_t closed = 0;
  for (const Closure& closure : session.closures) {
    if (!is_closed(closure) || ++closed > most) continue;
    if (closed == 1) {
      const char* unit = by_index ? "at scan" : "at [s]";
      lines += text("    %6s %9s %10s %10s %7s %8s %9s\n",
                    "query",
                    "reference",
                    unit,
                    unit,
                    "inliers",
                    "overlap",
                    "residual");
    }
    lines += closure_line(closure, begins);
  }
  if (closed > most)
    lines += text("    and %s more; --all lists them\n", with_commas(closed - most).c_str());
  return lines;
}

}  // namespace kissmap
