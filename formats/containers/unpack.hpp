// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace kissmap {

enum class Compression : std::uint8_t { none, lz4, bz2, zstd };

/// By the name bags and MCAP files give it: "", "none", "lz4", "bz2", "zstd". Throws Refusal for
/// any other.
Compression compression_named(std::string_view name);

/// Unpacks an LZ4 frame, a bzip2 stream or a zstd frame into `out`, whose memory is reused. `out`
/// begins with room for `size` bytes where that is no more than 64 times what is packed; otherwise
/// it grows with what comes. Throws Refusal when the stream is broken, or yields more or fewer
/// bytes than `size`; `out` holds what came before. `compression` is not none.
void unpack(Compression compression,
            std::span<const std::byte> packed,
            std::uint64_t size,
            std::vector<std::byte>& out);

/// A zstd frame that tells its own size, or not.
void unpack_zstd_message(std::span<const std::byte> packed, std::vector<std::byte>& out);

/// No chunk and no message is larger; a number above it is damage.
inline constexpr std::uint64_t max_unpacked_bytes = std::uint64_t{2} << 30;

}  // namespace kissmap
