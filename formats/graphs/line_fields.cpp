// SPDX-License-Identifier: MIT
#include "formats/graphs/line_fields.hpp"

#include <charconv>
#include <cmath>

#include "formats/text/lines.hpp"

namespace kissmap {
namespace {

template <typename Number>
bool parse(std::string_view text, Number& value) {
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && rest == end;
}

}  // namespace

std::string_view LineFields::word() {
  return next_word(rest_);
}

bool LineFields::take(std::string_view expected) {
  std::string_view rest = rest_;
  if (next_word(rest) != expected) return false;
  rest_ = rest;
  return true;
}

bool LineFields::at_end() const {
  return trimmed(rest_).empty();
}

void LineFields::end() const {
  if (!at_end()) throw error("unexpected " + in_quotes(trimmed(rest_)) + " at the end of the line");
}

double LineFields::number(const char* name) {
  const std::string_view text = word();
  if (text.empty()) throw error(std::string(name) + " is missing");
  double value = 0.0;
  // The sign that from_chars does not know.
  const std::string_view digits = text.size() > 1 && text[0] == '+' ? text.substr(1) : text;
  if (!parse(digits, value) || !std::isfinite(value)) {
    throw error(std::string(name) + " is " + in_quotes(text) + ", not a finite number");
  }
  return value;
}

std::int64_t LineFields::id(const char* name) {
  const std::string_view text = word();
  if (text.empty()) throw error(std::string(name) + " is missing");
  std::int64_t value = 0;
  if (!parse(text, value) || value < 0) {
    throw error(std::string(name) + " is " + in_quotes(text) + ", not a whole number from 0");
  }
  return value;
}

Rigid3 LineFields::pose() {
  constexpr double max_defect = 1e-2;  // files with two or three digits
  constexpr double exact = 1e-14;      // below, another normalisation would only change last bits
  Rigid3 pose;
  const char* axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) pose.translation[i] = number(axes[i]);
  const char* parts[] = {"qx", "qy", "qz", "qw"};
  for (int i = 0; i < 4; ++i) pose.rotation.coeffs()[i] = number(parts[i]);
  const double length = pose.rotation.norm();
  if (!(std::abs(length - 1.0) <= max_defect)) {
    throw error("the quaternion qx qy qz qw is of length " + std::to_string(length) + ", not 1");
  }
  if (std::abs(length - 1.0) > exact) pose.rotation.normalize();
  return pose;
}

Rigid3 LineFields::planar_pose() {
  const double x = number("x");
  const double y = number("y");
  const double half = 0.5 * number("theta");
  return {Eigen::Quaterniond(std::cos(half), 0.0, 0.0, std::sin(half)), Eigen::Vector3d(x, y, 0.0)};
}

Error LineFields::error(const std::string& message) const {
  return Error(Fault::input, path_.string() + ":" + std::to_string(number_) + ": " + message);
}

}  // namespace kissmap
