// SPDX-License-Identifier: MIT
#include "formats/session/pack_scan.hpp"

#include "formats/session/pack_columns.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

template <typename Enum>
Enum read_enum(ByteReader& bytes, Enum last) {
  const auto code = bytes.value<std::uint8_t>();
  if (code > static_cast<std::uint8_t>(last)) throw DamagedPack("a scan has an unknown property");
  return static_cast<Enum>(code);
}

void encode_properties(ByteWriter& bytes, const Scan& scan) {
  bytes.value(scan.stamp_ns);
  bytes.value(static_cast<std::uint8_t>(scan.stamp_is_index));
  bytes.value(static_cast<std::uint8_t>(scan.stamp_instant));
  bytes.value(static_cast<std::uint8_t>(scan.compensation));
  bytes.value(static_cast<std::uint8_t>(scan.time_source));
  bytes.value(scan.dropped.non_finite);
  bytes.value(scan.dropped.zero);
  bytes.value(scan.dropped.implausible);
}

Scan decode_properties(ByteReader& bytes) {
  Scan scan;
  scan.stamp_ns = bytes.value<std::int64_t>();
  scan.stamp_is_index = read_enum<std::uint8_t>(bytes, 1) != 0;
  scan.stamp_instant = read_enum(bytes, StampInstant::sweep_end);
  scan.compensation = read_enum(bytes, Compensation::yes);
  scan.time_source = read_enum(bytes, TimeSource::derived);
  scan.dropped.non_finite = bytes.value<std::uint64_t>();
  scan.dropped.zero = bytes.value<std::uint64_t>();
  scan.dropped.implausible = bytes.value<std::uint64_t>();
  return scan;
}

}  // namespace

std::string encode_scan(const std::string& name, const Scan& scan) {
  require_consistent(scan);
  ByteWriter bytes;
  bytes.text(name);
  encode_properties(bytes, scan);
  bytes.value(static_cast<std::uint32_t>(scan.points.size()));
  bytes.value(static_cast<std::uint32_t>(scan.no_return_directions.size()));
  encode_points(bytes, scan.points);
  encode_times(bytes, scan.time_offsets);
  encode_intensities(bytes, scan.intensities);
  encode_directions(bytes, scan.no_return_directions);
  encode_times(bytes, scan.no_return_time_offsets);
  return bytes.bytes();
}

std::string encode_refusal(const std::string& name, const RefusedScan& refusal) {
  ByteWriter bytes;
  bytes.text(name);
  bytes.text(refusal.reason);
  bytes.text(refusal.detail);
  return bytes.bytes();
}

LogEntry decode_scan(std::string_view packed) try {
  ByteReader bytes(packed);
  LogEntry entry;
  entry.name = bytes.text();
  Scan scan = decode_properties(bytes);
  const auto points = bytes.value<std::uint32_t>();
  const auto no_returns = bytes.value<std::uint32_t>();
  scan.points = decode_points(bytes, points);
  scan.time_offsets = decode_times(bytes, points);
  scan.intensities = decode_intensities(bytes, points);
  scan.no_return_directions = decode_directions(bytes, no_returns);
  scan.no_return_time_offsets = decode_times(bytes, no_returns);
  bytes.end();
  require_consistent(scan);
  entry.content = std::move(scan);
  return entry;
} catch (const Error& inconsistent) {
  throw DamagedPack(inconsistent.what());
}

LogEntry decode_refusal(std::string_view packed) {
  ByteReader bytes(packed);
  LogEntry entry;
  entry.name = bytes.text();
  RefusedScan refusal;
  refusal.reason = bytes.text();
  refusal.detail = bytes.text();
  bytes.end();
  entry.content = std::move(refusal);
  return entry;
}

}  // namespace kissmap
