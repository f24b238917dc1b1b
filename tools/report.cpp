// SPDX-License-Identifier: MIT
#include "report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "kissmap/error.hpp"

namespace kissmap {

std::string with_commas(std::uint64_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, ",");
  return digits;
}

std::string text(const char* pattern, ...) {
  va_list arguments;
  va_start(arguments, pattern);
  va_list again;
  va_copy(again, arguments);
  std::string result(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, pattern, arguments)),
                     '\0');
  std::vsnprintf(result.data(), result.size() + 1, pattern, again);
  va_end(again);
  va_end(arguments);
  return result;
}

std::string printable(std::string text, bool keep_lines) {
  std::ranges::replace_if(
      text,
      [keep_lines](unsigned char c) {
        return (c < 0x20 && !(keep_lines && c == '\n')) || c == 0x7F;
      },
      '?');
  return text;
}

std::string describe_refusals(const SessionCounts& counts) {
  std::string lines;
  for (const auto& [reason, refusals] : counts.scans_refused) {
    lines += "  left out    " + with_commas(refusals.count) +
             (refusals.count == 1 ? " scan: " : " scans: ") + reason + "\n";
    for (const std::string& example : refusals.examples)
      lines += "                " + printable(example) + "\n";
    if (refusals.count > refusals.examples.size()) lines += "                ...\n";
  }
  const DroppedReturns& dropped = counts.points_dropped;
  if (dropped.total() > 0) {
    lines += "  left out    " + with_commas(dropped.total()) +
             " returns: " + with_commas(dropped.non_finite) + " not finite, " +
             with_commas(dropped.zero) + " at the origin, " + with_commas(dropped.implausible) +
             " beyond 10 km\n";
  }
  if (counts.points_out_of_range > 0) {
    lines += "  left out    " + with_commas(counts.points_out_of_range) +
             " returns: outside min_range..max_range\n";
  }
  if (counts.scans_not_converged > 0) {
    lines += "  take care   " + with_commas(counts.scans_not_converged) +
             " scan(s) whose registration did not converge\n";
  }
  for (const StampGap& gap : counts.gaps) {
    lines += text("  take care   a gap of %.1f s before scan %llu\n",
                  gap.seconds,
                  static_cast<unsigned long long>(gap.log_index));
  }
  return lines;
}

std::string describe_loops(const std::vector<Closure>& closures) {
  const auto closed = std::ranges::count(closures, ClosureVerdict::accepted, &Closure::verdict);
  return text("  loops       %s closed, of %s candidates\n",
              with_commas(static_cast<std::uint64_t>(closed)).c_str(),
              with_commas(closures.size()).c_str());
}

ProductFrame frame_named(const std::string& name) {
  return name == name_of(ProductFrame::map) ? ProductFrame::map : ProductFrame::level;
}

std::string describe_frame(ProductFrame frame, const Rigid3& frame_from_map) {
  const Eigen::Vector3d& t = frame_from_map.translation;
  const Eigen::Quaterniond& q = frame_from_map.rotation;
  if (t.isZero(0.0) && q.vec().isZero(0.0)) return {};
  return text(
      "  frame       %s; from the session's map frame by x y z qx qy qz qw\n"
      "              %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n",
      name_of(frame),
      t.x(),
      t.y(),
      t.z(),
      q.x(),
      q.y(),
      q.z(),
      q.w());
}

std::string describe_offset(const std::filesystem::path& offset_file) {
  if (offset_file.empty()) return {};
  return "  take care   coordinates lack what is in " + printable(offset_file.string()) +
         ": the map is too far from its origin for single precision\n";
}

std::string describe_no_returns(double range, std::uint64_t no_returns) {
  if (!(range > 0.0)) return {};
  if (no_returns == 0) {
    return "  take care   the log tells of no ray without a return; --no-return-range did "
           "nothing\n";
  }
  return text("  no return   %s rays, free up to %g m\n", with_commas(no_returns).c_str(), range);
}

std::uint64_t bytes_of(double gigabytes) {
  constexpr double most = 1e6;
  if (!(gigabytes > 0.0 && gigabytes <= most)) {
    throw usage_error("--max-memory = " + text("%g", gigabytes) + " is not above 0 GB");
  }
  return static_cast<std::uint64_t>(std::ceil(1e9 * gigabytes));
}

std::string describe(const PackSummary& pack) {
  const double per_point =
      pack.points == 0 ? 0.0 : static_cast<double>(pack.bytes) / static_cast<double>(pack.points);
  return text("%.1f MB, %.2f bytes/point, coordinates in steps of %.0f mm",
              1e-6 * static_cast<double>(pack.bytes),
              per_point,
              1e3 * pack.resolution);
}

}  // namespace kissmap
