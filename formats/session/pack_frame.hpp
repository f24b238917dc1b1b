// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "formats/session/pack_bytes.hpp"

namespace kissmap {

// The outer layout of a pack: a file header, then frames. See FORMAT.md.

inline constexpr std::size_t pack_header_size = 32;
inline constexpr std::size_t frame_header_size = 40;

/// A scan larger than this when unpacked is neither written nor read: 25 million points.
inline constexpr std::uint32_t max_unpacked_size = 1U << 29;

enum class FrameKind : std::uint32_t { scan = 1, refused = 2, end = 3 };

struct FrameHeader {
  FrameKind kind = FrameKind::end;
  std::uint64_t index = 0;          ///< position in the log; of the end: number of entries
  std::uint32_t unpacked_size = 0;  ///< bytes
  std::uint32_t stored_size = 0;    ///< bytes that follow the header
  std::uint64_t stored_xxh3 = 0;    ///< XXH3-64 of these
};

std::string pack_header();
bool is_pack_start(std::string_view bytes);  ///< looks at the magic only
/// Throws DamagedPack unless the bytes are the header of a pack this program reads.
void require_pack_header(std::string_view bytes);

std::string frame_header(const FrameHeader& header);
/// Throws DamagedPack unless the checksum holds and the sizes are possible.
FrameHeader parse_frame_header(std::string_view bytes);

}  // namespace kissmap
