// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace kissmap {

/// A pause between two scans much longer than the log's usual scan interval.
struct StampGap {
  std::uint64_t log_index = 0;  ///< of the scan after the gap
  double seconds = 0.0;
};

/// Watches the stamps of a log (4 bytes a scan) and tells where it paused: where an interval is
/// over one second and over five times the median interval. Odometry predicts each scan from the
/// motion between the two before it, so its poses are least sure after a gap.
class StampGaps {
 public:
  /// Stamps must ascend.
  void observe(std::uint64_t log_index, std::int64_t stamp_ns);

  /// In order of the log.
  std::vector<StampGap> gaps() const;

 private:
  std::optional<std::int64_t> last_stamp_;
  std::vector<float> intervals_;      ///< s
  std::vector<StampGap> candidates_;  ///< intervals over one second
};

}  // namespace kissmap
