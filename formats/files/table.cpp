// SPDX-License-Identifier: MIT
#include "formats/files/table.hpp"

#include <charconv>
#include <cmath>
#include <utility>

namespace kissmap {
namespace {

// Far above the rounding of a normalised quaternion, far below any real damage.
constexpr double max_norm_error = 1e-6;

template <typename Number>
void append_chars(std::string& text, Number value) {
  char digits[32];
  const auto result = std::to_chars(digits, digits + sizeof digits, value);
  text.append(digits, result.ptr);
}

bool is_rigid(const Rigid3& transform) {
  return transform.translation.allFinite() && transform.rotation.coeffs().allFinite() &&
         std::abs(transform.rotation.norm() - 1.0) <= max_norm_error;
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  std::size_t begin = 0;
  for (std::size_t comma = 0; comma != std::string_view::npos; begin = comma + 1) {
    comma = line.find(',', begin);
    fields.push_back(line.substr(begin, comma - begin));
  }
  return fields;
}

}  // namespace

void append_number(std::string& text, double value) {
  append_chars(text, value);
}

void append_number(std::string& text, std::uint64_t value) {
  append_chars(text, value);
}

void append_number(std::string& text, std::int64_t value) {
  append_chars(text, value);
}

void append_pose(std::string& text, const Rigid3& transform, char separator) {
  if (!is_rigid(transform)) throw Error(Fault::internal, "a pose to be written is not rigid");
  for (const double value : transform.translation) {
    append_number(text, value);
    text += separator;
  }
  for (int i = 0; i < 4; ++i) {
    if (i > 0) text += separator;
    append_number(text, transform.rotation.coeffs()[i]);
  }
}

TableReader::TableReader(std::filesystem::path path, std::string_view header, std::string cure)
    : path_(std::move(path)), cure_(std::move(cure)), stream_(path_, std::ios::binary) {
  if (!stream_) throw input_error(path_, "cannot be opened; " + cure_);
  for (const std::string_view name : split(header)) names_.emplace_back(name);
  if (!next_row()) throw line_error("the header line is missing");
  if (line_ != header) throw line_error("the header is not '" + std::string(header) + "'");
}

bool TableReader::next_row() {
  ++line_number_;
  fields_read_ = 0;
  if (!std::getline(stream_, line_)) {
    if (stream_.bad()) throw line_error("cannot be read");
    return false;
  }
  if (stream_.eof()) throw line_error("the line is cut off");
  fields_ = split(line_);
  if (fields_.size() != names_.size()) {
    throw line_error(std::to_string(fields_.size()) + " columns instead of " +
                     std::to_string(names_.size()));
  }
  return true;
}

void TableReader::end_row() const {
  if (fields_read_ != names_.size()) throw Error(Fault::internal, "a table column was not read");
}

std::string_view TableReader::text() {
  if (fields_read_ >= fields_.size()) throw Error(Fault::internal, "no table column left to read");
  return fields_[fields_read_++];
}

template <typename Number>
Number TableReader::parse(const char* kind) {
  const std::string_view field = text();
  Number value{};
  const char* end = field.data() + field.size();
  const auto result = std::from_chars(field.data(), end, value);
  if (result.ec != std::errc{} || result.ptr != end) throw error(std::string("is not ") + kind);
  return value;
}

std::uint64_t TableReader::unsigned_integer() {
  return parse<std::uint64_t>("a whole number from 0");
}

std::uint32_t TableReader::unsigned_integer_32() {
  return parse<std::uint32_t>("a whole number from 0 to 4294967295");
}

std::int64_t TableReader::integer() {
  return parse<std::int64_t>("a whole number");
}

double TableReader::number() {
  const double value = parse<double>("a number");
  if (!std::isfinite(value)) throw error("is not a finite number");
  return value;
}

bool TableReader::flag() {
  const std::string_view field = text();
  if (field != "0" && field != "1") throw error("is neither 0 nor 1");
  return field == "1";
}

Rigid3 TableReader::pose() {
  Rigid3 transform;
  for (double& value : transform.translation) value = number();
  for (int i = 0; i < 4; ++i) transform.rotation.coeffs()[i] = number();
  if (!is_rigid(transform)) throw error("ends a rotation that is not of unit length");
  return transform;
}

Error TableReader::error(const std::string& message) const {
  const std::size_t column = fields_read_ - 1;
  return line_error("column " + names_[column] + " '" + std::string(fields_[column].substr(0, 40)) +
                    "' " + message);
}

Error TableReader::line_error(const std::string& message) const {
  return input_error(path_, "line " + std::to_string(line_number_) + ": " + message + "; " + cure_);
}

}  // namespace kissmap
