// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>
#include <string>

namespace kissmap {

/// Why one scan cannot be read while the log goes on. Logs turn it into a RefusedScan and put the
/// file's name in front of the detail.
class Refusal : public std::runtime_error {
 public:
  Refusal(const char* reason, const std::string& detail)
      : std::runtime_error(detail), reason_(reason) {}
  const char* reason() const { return reason_; }

 private:
  const char* reason_;
};

/// Reasons are counted by their text: one text per cause, no numbers or names in it.
namespace refusal_reason {
inline constexpr const char* unreadable = "unreadable file";
inline constexpr const char* empty = "empty file";
inline constexpr const char* too_large = "file too large for one scan";
inline constexpr const char* truncated = "truncated file";
inline constexpr const char* wrong_size = "wrong file size";
inline constexpr const char* wrong_kind = "not what its name says";
inline constexpr const char* broken_header = "broken header";
inline constexpr const char* broken_content = "broken content";
inline constexpr const char* no_coordinates = "no x, y, z";
inline constexpr const char* no_time_field = "time field not found";
inline constexpr const char* no_stamp = "no stamp";
inline constexpr const char* unsupported = "not supported";
}  // namespace refusal_reason

}  // namespace kissmap
