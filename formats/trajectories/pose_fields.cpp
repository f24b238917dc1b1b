// SPDX-License-Identifier: MIT
#include "formats/trajectories/pose_fields.hpp"

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>

#include "formats/text/lines.hpp"

namespace kissmap {
namespace {

// Four decimals, as some published files have, leave a quaternion off by 1e-4.
constexpr double max_rotation_error = 0.01;
constexpr double max_coordinate = 1e9;  // m

}  // namespace

Fields split_at_spaces(std::string_view line) {
  Fields fields;
  for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
    fields.push_back(word);
  }
  return fields;
}

Fields split_at_commas(std::string_view line) {
  Fields fields;
  for (std::size_t begin = 0, comma = 0; comma != std::string_view::npos; begin = comma + 1) {
    comma = line.find(',', begin);
    fields.push_back(trimmed(line.substr(begin, comma - begin)));
  }
  return fields;
}

double number(std::string_view field) {
  const std::string_view digits = field.starts_with('+') ? field.substr(1) : field;
  double value = 0.0;
  const char* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, value);
  if (error == std::errc::result_out_of_range && stop == end && digits.find("e-") != digits.npos) {
    return 0.0;  // smaller than any double
  }
  if (error != std::errc() || stop != end || !std::isfinite(value)) {
    throw std::invalid_argument(in_quotes(field) + " is not a finite number");
  }
  return value;
}

Eigen::Vector3d position(std::span<const std::string_view> fields) {
  Eigen::Vector3d p(number(fields[0]), number(fields[1]), number(fields[2]));
  if (p.cwiseAbs().maxCoeff() > max_coordinate) {
    throw std::invalid_argument("a position beyond 1e9 m; are the columns in order?");
  }
  return p;
}

Eigen::Quaterniond unit_quaternion(const Eigen::Quaterniond& q) {
  const double norm = q.norm();
  if (std::abs(norm - 1.0) <= max_rotation_error) return q.normalized();
  throw std::invalid_argument("the quaternion has length " + std::to_string(norm) +
                              " instead of 1; are the columns in order?");
}

void require_columns(const Fields& fields, std::size_t least, std::size_t most) {
  if (fields.size() >= least && fields.size() <= most) return;
  throw std::invalid_argument(std::to_string(fields.size()) + " columns instead of " +
                              std::to_string(least) + "; is the line cut?");
}

Rigid3 pose_of_rows(std::span<const std::string_view> fields) {
  Eigen::Matrix<double, 3, 4> matrix;
  for (Eigen::Index i = 0; i < 12; ++i) {
    matrix(i / 4, i % 4) = number(fields[static_cast<std::size_t>(i)]);
  }
  const Eigen::Matrix3d rotation = matrix.leftCols<3>();
  const Eigen::Matrix3d excess = rotation * rotation.transpose() - Eigen::Matrix3d::Identity();
  if (!(excess.cwiseAbs().maxCoeff() <= max_rotation_error) || rotation.determinant() < 0.0) {
    throw std::invalid_argument("columns 1-3, 5-7 and 9-11 are no rotation; are they in order?");
  }
  position(std::vector<std::string_view>{fields[3], fields[7], fields[11]});
  return Rigid3::from_matrix(matrix);
}

}  // namespace kissmap
