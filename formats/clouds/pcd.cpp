// SPDX-License-Identifier: MIT
#include "formats/clouds/pcd.hpp"

#include <liblzf/lzf.h>

#include <cstring>
#include <limits>
#include <string>

#include "formats/clouds/ascii_records.hpp"
#include "formats/clouds/pcd_header.hpp"
#include "formats/clouds/refusal.hpp"
#include "formats/text/lines.hpp"

namespace kissmap {
namespace {

/// LZF turns three bytes into 264 at best.
constexpr std::uint64_t max_lzf_ratio = 88;

[[noreturn]] void refuse_short(const PcdHeader& header, std::size_t size) {
  throw Refusal(refusal_reason::truncated,
                "byte " + std::to_string(header.size) + ": " + std::to_string(header.points) +
                    " points of " + std::to_string(header.stride) +
                    " bytes are promised, the file holds " + std::to_string(size) +
                    " bytes behind the header; is it cut?");
}

PointRecords records_of(const PcdHeader& header) {
  PointRecords records;
  records.layout.fields = header.fields;
  records.count = header.points;
  return records;
}

PointRecords read_binary(const PcdHeader& header, std::span<const std::byte> payload) {
  if (header.points > payload.size() / header.stride) refuse_short(header, payload.size());
  PointRecords records = records_of(header);
  records.bytes = payload.first(header.points * header.stride);
  return records;
}

PointRecords read_ascii(const PcdHeader& header, std::span<const std::byte> payload) {
  // A point takes two characters a value at least, but for the last line's end.
  if (header.points > payload.size() / 2 + 1) refuse_short(header, payload.size());
  PointRecords records = records_of(header);
  records.layout.byte_order = std::endian::native;
  Lines lines(text_of(payload));
  for (std::size_t i = 0; i < header.points; ++i) {
    const auto line = lines.next_not_blank();
    if (!line) {
      throw Refusal(refusal_reason::truncated,
                    std::to_string(header.points) + " points are promised, the file ends after " +
                        std::to_string(i) + "; is it cut?");
    }
    append_record(*line, header.lines + lines.number(), header.fields, records.storage);
  }
  if (lines.next_not_blank()) {
    throw Refusal(refusal_reason::broken_content,
                  "line " + std::to_string(header.lines + lines.number()) +
                      ": more points than the " + std::to_string(header.points) + " of POINTS");
  }
  records.bytes = records.storage;
  return records;
}

std::uint32_t load_u32(std::span<const std::byte> bytes) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data(), sizeof(value));
  return std::endian::native == std::endian::big ? __builtin_bswap32(value) : value;
}

// The planes lie one behind the other: all x, then all y ...
void turn_into_planes(PointRecords& records) {
  std::size_t begin = 0;
  for (RecordField& field : records.layout.fields) {
    field.offset = begin;
    field.stride = size_of(field.type) * field.count;
    begin += field.stride * records.count;
  }
}

PointRecords read_compressed(const PcdHeader& header, std::span<const std::byte> payload) {
  if (payload.size() < 8) refuse_short(header, payload.size());
  const std::uint32_t packed_size = load_u32(payload);
  const std::uint32_t raw_size = load_u32(payload.subspan(4));
  const std::string place = "byte " + std::to_string(header.size) + ": ";
  if (header.points > raw_size / header.stride || header.points * header.stride != raw_size) {
    throw Refusal(refusal_reason::broken_header,
                  place + "the points unpack to " + std::to_string(raw_size) + " bytes, but " +
                      std::to_string(header.points) + " points have " +
                      std::to_string(header.stride) + " bytes each");
  }
  if (packed_size > payload.size() - 8) {
    throw Refusal(refusal_reason::truncated,
                  place + std::to_string(packed_size) + " packed bytes are promised, the file " +
                      "holds " + std::to_string(payload.size() - 8) + "; is it cut?");
  }
  PointRecords records = records_of(header);
  turn_into_planes(records);
  if (raw_size == 0) return records;
  const bool possible = raw_size <= max_lzf_ratio * packed_size;
  records.storage.resize(possible ? raw_size : 0);
  if (!possible ||
      lzf_decompress(payload.data() + 8, packed_size, records.storage.data(), raw_size) !=
          raw_size) {
    throw Refusal(refusal_reason::broken_content,
                  place + "the compressed points are damaged; copy the file anew");
  }
  records.bytes = records.storage;
  return records;
}

}  // namespace

bool looks_like_pcd(std::span<const std::byte> first_bytes) {
  Lines lines(text_of(first_bytes));
  while (auto line = lines.next_not_blank()) {
    const std::string_view word = next_word(*line);
    if (word == "#" && next_word(*line) == ".PCD") return true;
    if (word.starts_with('#')) continue;
    return word == "VERSION" || word == "FIELDS" || word == "COLUMNS";
  }
  return false;
}

PointRecords read_pcd(std::span<const std::byte> file) {
  const PcdHeader header = read_pcd_header(file);
  const std::span<const std::byte> payload = file.subspan(header.size);
  switch (header.encoding) {
    case PcdEncoding::ascii:
      return read_ascii(header, payload);
    case PcdEncoding::binary:
      return read_binary(header, payload);
    case PcdEncoding::binary_compressed:
      break;
  }
  return read_compressed(header, payload);
}

}  // namespace kissmap
