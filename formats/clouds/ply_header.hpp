// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/clouds/record_layout.hpp"

namespace kissmap {

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::f32;     ///< of the value, or of a list's values
  std::optional<ScalarType> list_count;  ///< type of a list's length; none for a single value
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_lists() const;
  std::size_t stride() const;  ///< bytes of an element without lists
};

struct PlyHeader {
  bool ascii = true;
  std::endian byte_order = std::endian::little;
  std::vector<PlyElement> elements;
  std::size_t size = 0;   ///< bytes of the header
  std::size_t lines = 0;  ///< lines of the header
};

/// Throws Refusal naming the line.
PlyHeader read_ply_header(std::span<const std::byte> file);

}  // namespace kissmap
