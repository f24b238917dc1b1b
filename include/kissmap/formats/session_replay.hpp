// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "kissmap/formats/session.hpp"
#include "kissmap/mapping/placed_scan.hpp"

namespace kissmap {

/// Whether a replay also places shots that nothing came back of, which takes time.
enum class NoReturns : std::uint8_t { left_out, placed };

/// The scans of a finished session, read again from its log (or pack) and placed by its final
/// trajectory, deskewed with that trajectory, too. Reads ahead on a thread of its own; memory holds
/// a few scans. To start again, make another. Not thread safe.
class SessionReplay {
 public:
  /// `session` must outlive the replay. Points nearer than min_range or farther than max_range [m]
  /// are left out. Throws Error(input) where the log is missing or not the one mapped; `moved_to`
  /// says where it is now. Of the scans the first is given and each `every`th after it, >= 1; those
  /// between are not decoded, and nothing is read ahead then.
  SessionReplay(const Session& session,
                double min_range,
                double max_range,
                const std::filesystem::path& moved_to = {},
                std::uint64_t every = 1,
                NoReturns no_returns = NoReturns::left_out);

  /// The next scan, or nothing after the last. Throws Error(input) where the log has changed or
  /// ends too early.
  std::optional<PlacedScan> next();

  std::uint64_t size() const { return session_.scans.size(); }  ///< of the session

 private:
  const Session& session_;
  std::unique_ptr<ScanLog> log_;
  double min_range_;
  double max_range_;
  std::uint64_t every_;
  NoReturns no_returns_;
  std::uint64_t next_idx_ = 0;
};

}  // namespace kissmap
