// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "kissmap/error.hpp"
#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// The words of one line of a text file, taken one by one. All members throw Error(input) with
/// file and line.
class LineFields {
 public:
  LineFields(const std::filesystem::path& path, std::size_t number, std::string_view line)
      : path_(path), number_(number), rest_(line) {}

  std::string_view word();               ///< empty at the end
  bool take(std::string_view expected);  ///< takes the next word if it is this one
  bool at_end() const;
  void end() const;  ///< throws unless all words have been taken

  double number(const char* name);    ///< finite
  std::int64_t id(const char* name);  ///< 0 or more
  Rigid3 pose();  ///< x y z qx qy qz qw; lengths of the rotation within 1 % of 1 are repaired
  Rigid3 planar_pose();  ///< x y theta

  Error error(const std::string& message) const;

 private:
  const std::filesystem::path& path_;
  std::size_t number_;
  std::string_view rest_;
};

}  // namespace kissmap
