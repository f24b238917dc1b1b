// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "formats/sensors/ouster_metadata.hpp"

namespace kissmap {

/// Bits of a pixel, counted from its first byte, low bits first.
struct OusterField {
  unsigned offset = 0;
  unsigned width = 0;  ///< 0: the profile has no such field
};

/// How a profile writes a pixel.
struct OusterProfile {
  std::string_view name;
  std::size_t pixel_bytes = 0;
  std::uint32_t range_step_mm = 1;
  OusterField range[2];  ///< of the first and the second return
  OusterField signal[2];
  OusterField reflectivity[2];
  OusterField near_ir;
};

/// Throws Refusal naming a profile that is not known.
const OusterProfile& ouster_profile(std::string_view name);

struct OusterColumn {
  std::uint64_t timestamp_ns = 0;  ///< the sensor's clock
  std::uint16_t measurement_id = 0;
  std::uint16_t frame_id = 0;
  bool valid = false;
  std::uint32_t status = 0;
  std::span<const std::byte> pixels;
};

/// Finds columns in data packets. Layout: Ouster's firmware user manual, and
/// ouster-lidar/ouster-sdk, parsing.cpp.
class OusterPackets {
 public:
  /// Throws Refusal for a profile that is not known.
  explicit OusterPackets(const OusterMetadata& about);

  const OusterProfile& profile() const { return profile_; }
  std::size_t packet_bytes() const;
  /// The session a packet was sent in; none where the profile does not tell.
  std::optional<std::uint32_t> initialization_id(std::span<const std::byte> packet) const;
  /// `packet` has packet_bytes(); `index` counts its columns.
  OusterColumn column(std::span<const std::byte> packet, std::size_t index) const;

  static std::uint64_t read(std::span<const std::byte> pixel, OusterField field);

 private:
  bool legacy() const { return profile_.name == "LEGACY"; }
  std::size_t header_bytes() const { return legacy() ? 0 : 32; }
  std::size_t column_header_bytes() const { return legacy() ? 16 : 12; }
  std::size_t column_bytes() const;

  const OusterProfile& profile_;
  std::size_t beams_;
  std::size_t columns_;
};

}  // namespace kissmap
