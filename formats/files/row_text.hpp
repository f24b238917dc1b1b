// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "formats/files/table.hpp"
#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// Names of the seven columns of a pose.
inline std::string pose_columns(const std::string& name) {
  std::string columns;
  for (const char* part : {"_x", "_y", "_z", "_qx", "_qy", "_qz", "_qw"}) {
    columns += (columns.empty() ? "" : ",") + name + part;
  }
  return columns;
}

/// Appends the fields of a row one by one, commas between them.
class RowText {
 public:
  template <typename Number>
  RowText& number(Number value) {
    separate();
    append_number(text_, value);
    return *this;
  }
  RowText& flag(bool value) { return word(value ? "1" : "0"); }
  RowText& word(const char* value) {
    separate();
    text_ += value;
    return *this;
  }
  RowText& pose(const Rigid3& transform) {
    separate();
    append_pose(text_, transform, ',');
    return *this;
  }
  std::string line() { return text_ + '\n'; }

 private:
  void separate() {
    if (!text_.empty()) text_ += ',';
  }
  std::string text_;
};

}  // namespace kissmap
