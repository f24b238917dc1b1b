// SPDX-License-Identifier: MIT
#include "formats/containers/unpack.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>

#include "formats/clouds/refusal.hpp"

namespace kissmap {
namespace {

// How much `out` grows at a time, at least: a number in the file alone allocates no more.
constexpr std::size_t growth = std::size_t{1} << 20;

// Clouds shrink to a half or a tenth; an announced size within this of what is packed is believed.
constexpr std::uint64_t plausible_ratio = 64;

[[noreturn]] void broken(const char* kind, const char* why) {
  throw Refusal(refusal_reason::broken_content, std::string(kind) + " data broken: " + why);
}

/// Room for more bytes behind the `used` ones of `out`; never for more than `most` in all, nor
/// for more than twice what was used plus a step.
std::span<std::byte> room_in(std::vector<std::byte>& out, std::size_t used, std::uint64_t most) {
  if (used == out.size()) {
    const std::uint64_t wanted = std::max<std::uint64_t>(2 * used, used + growth);
    out.resize(static_cast<std::size_t>(std::min(most, wanted)));
  }
  const auto end = static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), most));
  return std::span(out).first(end).subspan(used);
}

/// Room for all of `size` bytes and one more, where as many are plausible: decoders are fastest
/// when they write to where the bytes stay.
void make_plausible_room(std::vector<std::byte>& out, std::size_t packed, std::uint64_t size) {
  if (size > max_unpacked_bytes || size > plausible_ratio * packed) return;
  if (out.size() <= size) out.resize(static_cast<std::size_t>(size) + 1);
}

/// One step of a decoder: takes from `in`, fills `to`.
struct Step {
  std::size_t consumed = 0;
  std::size_t produced = 0;
  bool at_end = false;  ///< of the stream, after these bytes
};

/// Drives a decoder over the input. One byte of room beyond `size` tells a stream that is too long.
template <class Decode>
void unpack_stream(const char* kind,
                   std::span<const std::byte> in,
                   std::uint64_t size,
                   bool exact,
                   std::vector<std::byte>& out,
                   Decode decode) {
  std::size_t used = 0;
  bool at_end = false;
  if (exact) make_plausible_room(out, in.size(), size);
  const auto keep_what_came = [&] {
    out.resize(static_cast<std::size_t>(std::min<std::uint64_t>(used, size)));
  };
  try {
    while (!at_end) {
      const auto room = room_in(out, used, size + 1);
      if (room.empty()) broken(kind, "it holds more than is announced");
      const Step step = decode(in, room);
      in = in.subspan(step.consumed);
      used += step.produced;
      at_end = step.at_end;
      if (!at_end && step.consumed == 0 && step.produced == 0) broken(kind, "it ends early");
    }
    if (used > size) broken(kind, "it holds more than is announced");
    if (exact && used < size) broken(kind, "it holds less than is announced");
  } catch (...) {
    keep_what_came();
    throw;
  }
  keep_what_came();
}

void unpack_lz4(std::span<const std::byte> packed,
                std::uint64_t size,
                std::vector<std::byte>& out) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0U)
    throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(
      raw, LZ4F_freeDecompressionContext);
  unpack_stream("LZ4", packed, size, true, out, [&](auto in, auto room) {
    std::size_t consumed = in.size();
    std::size_t produced = room.size();
    // Where all has room nothing is moved, and the decoder may look back into it.
    LZ4F_decompressOptions_t options{};
    options.stableDst = room.size() > size ? 1 : 0;
    const std::size_t hint =
        LZ4F_decompress(raw, room.data(), &produced, in.data(), &consumed, &options);
    if (LZ4F_isError(hint) != 0U) broken("LZ4", LZ4F_getErrorName(hint));
    return Step{consumed, produced, hint == 0};
  });
}

void unpack_bz2(std::span<const std::byte> packed,
                std::uint64_t size,
                std::vector<std::byte>& out) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> end(&stream, BZ2_bzDecompressEnd);
  unpack_stream("bzip2", packed, size, true, out, [&](auto in, auto room) {
    // bzlib counts in 32 bits.
    const auto in_size = static_cast<unsigned>(std::min<std::size_t>(in.size(), 1U << 30));
    const auto room_size = static_cast<unsigned>(std::min<std::size_t>(room.size(), 1U << 30));
    stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(in.data()));
    stream.avail_in = in_size;
    stream.next_out = reinterpret_cast<char*>(room.data());
    stream.avail_out = room_size;
    const int result = BZ2_bzDecompress(&stream);
    if (result != BZ_OK && result != BZ_STREAM_END) broken("bzip2", "its check sums fail");
    return Step{in_size - stream.avail_in, room_size - stream.avail_out, result == BZ_STREAM_END};
  });
}

void unpack_zstd(std::span<const std::byte> packed,
                 std::uint64_t size,
                 bool exact,
                 std::vector<std::byte>& out) {
  const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(),
                                                                        ZSTD_freeDCtx);
  if (!context) throw std::bad_alloc();
  unpack_stream("zstd", packed, size, exact, out, [&](auto in, auto room) {
    ZSTD_inBuffer from{in.data(), in.size(), 0};
    ZSTD_outBuffer to{room.data(), room.size(), 0};
    const std::size_t hint = ZSTD_decompressStream(context.get(), &to, &from);
    if (ZSTD_isError(hint) != 0U) broken("zstd", ZSTD_getErrorName(hint));
    return Step{from.pos, to.pos, hint == 0};
  });
}

}  // namespace

Compression compression_named(std::string_view name) {
  if (name.empty() || name == "none") return Compression::none;
  if (name == "lz4") return Compression::lz4;
  if (name == "bz2") return Compression::bz2;
  if (name == "zstd") return Compression::zstd;
  throw Refusal(refusal_reason::unsupported,
                "compression '" + std::string(name.substr(0, 40)) +
                    "' is not supported: none, lz4, bz2 and zstd are");
}

void unpack(Compression compression,
            std::span<const std::byte> packed,
            std::uint64_t size,
            std::vector<std::byte>& out) {
  if (size > max_unpacked_bytes) {
    out.clear();
    throw Refusal(refusal_reason::too_large,
                  "unpacked it would have " + std::to_string(size) + " bytes");
  }
  switch (compression) {
    case Compression::none:
      break;
    case Compression::lz4:
      unpack_lz4(packed, size, out);
      return;
    case Compression::bz2:
      unpack_bz2(packed, size, out);
      return;
    case Compression::zstd:
      unpack_zstd(packed, size, true, out);
      return;
  }
  throw std::logic_error("unpack of what is not packed");
}

void unpack_zstd_message(std::span<const std::byte> packed, std::vector<std::byte>& out) {
  // Beyond this are the marks of a frame that does not tell, or is none.
  const std::uint64_t told = ZSTD_getFrameContentSize(packed.data(), packed.size());
  const bool exact = told <= max_unpacked_bytes;
  unpack_zstd(packed, exact ? told : max_unpacked_bytes, exact, out);
}

}  // namespace kissmap
