// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "kissmap/error.hpp"
#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// Shortest decimal text that reads back as exactly the same number. Independent of the locale.
void append_number(std::string& text, double value);
void append_number(std::string& text, std::uint64_t value);
void append_number(std::string& text, std::int64_t value);

/// x, y, z, qx, qy, qz, qw with `separator` between them. Throws Error(internal) for a transform
/// that is not finite or whose rotation is not of unit length.
void append_pose(std::string& text, const Rigid3& transform, char separator);

/// Reads a comma separated table row by row. Lines end in "\n", the last one too; no quoting.
/// All members throw Error(input) naming file, line, column and cure.
class TableReader {
 public:
  /// `header` is the first line the table must have; `cure` ends every message.
  TableReader(std::filesystem::path path, std::string_view header, std::string cure);

  bool next_row();       ///< false at the end
  void end_row() const;  ///< throws unless every column has been read

  // The next column of the row.
  std::uint64_t unsigned_integer();
  std::uint32_t unsigned_integer_32();
  std::int64_t integer();
  double number();  ///< finite
  bool flag();      ///< 0 or 1
  Rigid3 pose();    ///< seven columns, rotation of unit length
  std::string_view text();

  /// An error at the column read last.
  Error error(const std::string& message) const;

 private:
  Error line_error(const std::string& message) const;
  template <typename Number>
  Number parse(const char* kind);

  std::filesystem::path path_;
  std::string cure_;
  std::vector<std::string> names_;
  std::ifstream stream_;
  std::string line_;
  std::vector<std::string_view> fields_;
  std::size_t line_number_ = 0;
  std::size_t fields_read_ = 0;
};

}  // namespace kissmap
