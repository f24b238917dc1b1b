// SPDX-License-Identifier: MIT
#include "formats/logs/lvx_times.hpp"

#include <cstring>
#include <span>
#include <vector>

#include "formats/clouds/refusal.hpp"
#include "formats/containers/byte_cursor.hpp"

namespace kissmap {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::uint64_t tail_bytes = 4 << 20;
constexpr std::size_t links_bytes = 16;                         // of a frame, to itself and on
constexpr std::uint64_t latest_ns = 4'000'000'000'000'000'000;  // later is damage

struct Packet {
  std::uint8_t sensor = 0;
  std::uint64_t time_ns = 0;
};

std::optional<Packet> first_packet(const ContainerFile& file, std::uint64_t place) {
  std::vector<std::byte> buffer;
  try {
    ByteCursor cursor(file.read(place, 19, buffer));
    Packet packet;
    packet.sensor = cursor.value<std::uint8_t>();
    cursor.take(10);
    packet.time_ns = cursor.value<std::uint64_t>();
    if (packet.time_ns < latest_ns) return packet;
  } catch (const Refusal&) {
    // The file ends in it.
  }
  return std::nullopt;
}

std::uint64_t u64(Bytes bytes, std::size_t at) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.subspan(at, sizeof(value)).data(), sizeof(value));
  return value;
}

// A frame begins with its own place in the file and that of the next, 0 in the last one.
std::optional<std::uint64_t> last_frame(const ContainerFile& file) {
  const std::uint64_t begin = file.size() > tail_bytes ? file.size() - tail_bytes : 0;
  std::vector<std::byte> buffer;
  const Bytes tail = file.read(begin, tail_bytes, buffer);
  std::optional<std::uint64_t> last;
  for (std::size_t at = 0; at + links_bytes <= tail.size(); ++at) {
    if (u64(tail, at) != begin + at) continue;
    last = begin + at;
    const std::uint64_t next = u64(tail, at + 8);
    if (next == 0 || next >= file.size()) break;
    // On to the next one at once: what points hold may look like a frame.
    if (next > begin + at) at = static_cast<std::size_t>(next - begin) - 1;
  }
  return last;
}

}  // namespace

std::optional<std::pair<std::int64_t, std::int64_t>> lvx_time_range(const ContainerFile& file,
                                                                    std::uint64_t first_frame,
                                                                    std::size_t frame_head_bytes) {
  const auto last_place = last_frame(file);
  if (!last_place || *last_place <= first_frame) return std::nullopt;
  const auto first = first_packet(file, first_frame + frame_head_bytes);
  const auto last = first_packet(file, *last_place + frame_head_bytes);
  if (!first || !last || first->sensor != last->sensor || last->time_ns <= first->time_ns) {
    return std::nullopt;
  }
  return std::pair(static_cast<std::int64_t>(first->time_ns),
                   static_cast<std::int64_t>(last->time_ns));
}

}  // namespace kissmap
