// SPDX-License-Identifier: MIT
#include "formats/containers/packet_capture.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "formats/clouds/gather.hpp"
#include "formats/clouds/refusal.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::uint32_t most_block_bytes = 1 << 22;  // no frame and no block is larger
constexpr std::uint32_t most_frame_bytes = 1 << 18;  // what capturing programs keep of one
constexpr std::int64_t longest_capture_s = 10'000'000;
constexpr std::uint32_t section_block = 0x0A0D0D0A;
constexpr std::uint32_t byte_order_magic = 0x1A2B3C4D;
constexpr std::int64_t ns_per_s = 1'000'000'000;
// Nothing is recorded later, and no clock is set farther off: so sums fit into 64 bits.
constexpr std::uint64_t latest_s = 4'000'000'000;
constexpr std::int64_t farthest_offset_s = 1'000'000'000;

enum Block : std::uint32_t {
  interface_block = 1,
  packet_block = 2,
  simple_packet_block = 3,
  enhanced_packet_block = 6
};

[[noreturn]] void cut() {
  throw Refusal(refusal_reason::truncated, "the file ends inside of a packet");
}

std::int64_t to_ns(std::uint64_t ticks, std::uint64_t ticks_per_s) {
  const std::uint64_t seconds = ticks / ticks_per_s;
  const std::uint64_t rest = ticks % ticks_per_s;
  const auto fraction = static_cast<std::uint64_t>(static_cast<long double>(rest) *
                                                   static_cast<long double>(ns_per_s) /
                                                   static_cast<long double>(ticks_per_s));
  return static_cast<std::int64_t>(std::min(seconds, latest_s)) * ns_per_s +
         static_cast<std::int64_t>(fraction);
}

}  // namespace

PacketCapture::PacketCapture(const std::filesystem::path& path) : file_(path), window_(file_) {
  const Bytes head = window_.at(0, 24);
  if (head.size() < 24) {
    throw input_error(path,
                      file_.size() == 0 ? "has 0 bytes; copy it anew" : "is no packet capture");
  }
  const std::uint32_t magic = u32(head, 0);
  if (magic == section_block) {
    next_generation_ = true;
    return;
  }
  for (const bool nanoseconds : {false, true}) {
    const std::uint32_t expected = nanoseconds ? 0xA1B23C4D : 0xA1B2C3D4;
    if (magic != expected && magic != gather_detail::swapped(expected)) continue;
    nanoseconds_ = nanoseconds;
    swap_ = magic != expected;
    interfaces_.push_back(
        {u32(head, 20) & 0x0FFFFFFFU, nanoseconds ? 1'000'000'000U : 1'000'000U, 0});
    offset_ = 24;
    return;
  }
  throw input_error(path, "is no packet capture: neither pcap nor pcapng");
}

std::uint32_t PacketCapture::u32(Bytes bytes, std::size_t at) const {
  return gather_detail::load<std::uint32_t>(bytes.subspan(at, 4).data(), swap_);
}

std::uint16_t PacketCapture::u16(Bytes bytes, std::size_t at) const {
  return gather_detail::load<std::uint16_t>(bytes.subspan(at, 2).data(), swap_);
}

std::optional<PacketCapture::Frame> PacketCapture::next_pcap_frame() {
  const Bytes head = window_.at(offset_, 16);
  if (head.empty()) {
    ended_ = true;
    return std::nullopt;
  }
  if (head.size() < 16) cut();
  const std::uint32_t captured = u32(head, 8);
  if (captured > most_block_bytes) {
    throw Refusal(refusal_reason::broken_content, "no packet begins here");
  }
  Frame frame;
  frame.link_type = interfaces_[0].link_type;
  frame.whole = captured >= u32(head, 12);
  frame.received_ns = std::int64_t{u32(head, 0)} * ns_per_s +
                      std::int64_t{u32(head, 4)} * (nanoseconds_ ? 1 : 1000);
  frame.bytes = window_.at(offset_ + 16, captured);
  if (frame.bytes.size() < captured) cut();
  offset_ += 16 + captured;
  return frame;
}

// Tells the byte order of what follows.
void PacketCapture::begin_section(std::uint64_t offset) {
  const Bytes head = window_.at(offset, 12);
  if (head.size() < 12) cut();
  swap_ = false;
  if (u32(head, 8) != byte_order_magic) swap_ = true;
  if (u32(head, 8) != byte_order_magic) {
    throw Refusal(refusal_reason::broken_content, "a section of no known byte order");
  }
  interfaces_.clear();
}

void PacketCapture::add_interface(Bytes body) {
  if (body.size() < 8) cut();
  Interface added;
  added.link_type = u16(body, 0);
  Bytes options = body.subspan(8);
  while (options.size() >= 4) {
    const std::uint16_t code = u16(options, 0);
    const std::size_t size = u16(options, 2);
    if (code == 0 || size > options.size() - 4) break;
    const Bytes value = options.subspan(4, size);
    if (code == 9 && size >= 1) {  // resolution of times: a power of 10, or of 2
      const auto power = std::to_integer<unsigned>(value[0]);
      added.ticks_per_s = 1;
      if ((power & 0x80U) != 0) {
        added.ticks_per_s <<= std::min(power & 0x7FU, 62U);
      } else {
        for (unsigned i = 0; i < std::min(power, 18U); ++i) added.ticks_per_s *= 10;
      }
    }
    if (code == 14 && size >= 8) {  // seconds to add to times
      added.offset_s = gather_detail::load<std::int64_t>(value.data(), swap_);
      if (added.offset_s < -farthest_offset_s || added.offset_s > farthest_offset_s)
        added.offset_s = 0;
    }
    options = options.subspan(std::min(options.size(), 4 + (size + 3) / 4 * 4));
  }
  interfaces_.push_back(added);
}

const PacketCapture::Interface& PacketCapture::interface(std::uint32_t number) const {
  if (number < interfaces_.size()) return interfaces_[number];
  throw Refusal(refusal_reason::broken_content, "a packet of an interface that is not described");
}

std::optional<PacketCapture::Frame> PacketCapture::read_packet_block(std::uint32_t type,
                                                                     Bytes body) {
  Frame frame;
  if (type == simple_packet_block) {  // without a time
    if (body.size() < 4) cut();
    frame.link_type = interface(0).link_type;
    frame.bytes = body.subspan(4, std::min<std::size_t>(body.size() - 4, u32(body, 0)));
    frame.whole = frame.bytes.size() >= u32(body, 0);
    return frame;
  }
  if (body.size() < 20) cut();
  const Interface& from = interface(type == packet_block ? u16(body, 0) : u32(body, 0));
  const std::uint32_t captured = u32(body, 12);
  if (captured > body.size() - 20) {
    throw Refusal(refusal_reason::broken_content, "a packet longer than its block");
  }
  const std::uint64_t ticks = (std::uint64_t{u32(body, 4)} << 32U) | u32(body, 8);
  frame.link_type = from.link_type;
  frame.received_ns = to_ns(ticks, from.ticks_per_s) + from.offset_s * ns_per_s;
  frame.bytes = body.subspan(20, captured);
  frame.whole = captured >= u32(body, 16);
  return frame;
}

std::optional<PacketCapture::Frame> PacketCapture::next_block() {
  const Bytes head = window_.at(offset_, 8);
  if (head.empty()) {
    ended_ = true;
    return std::nullopt;
  }
  if (head.size() < 8) cut();
  std::uint32_t type = u32(head, 0);
  if (type == section_block) begin_section(offset_);
  const std::uint32_t size = u32(window_.at(offset_, 8), 4);
  if (size < 12 || size % 4 != 0 || size > most_block_bytes) {
    throw Refusal(refusal_reason::broken_content, "no block begins here");
  }
  const Bytes block = window_.at(offset_, size);
  if (block.size() < size) cut();
  offset_ += size;
  const Bytes body = block.subspan(8, size - 12);
  if (type == interface_block) add_interface(body);
  const bool packet =
      type == packet_block || type == simple_packet_block || type == enhanced_packet_block;
  return packet ? read_packet_block(type, body) : std::nullopt;
}

std::uint64_t PacketCapture::frame_size(Bytes bytes, std::size_t at) const {
  constexpr std::size_t most_head = 16;
  if (bytes.size() - at < most_head) return 0;
  if (next_generation_) {
    const std::uint32_t size = u32(bytes, at + 4);
    if (size < 12 || size % 4 != 0 || size > most_block_bytes) return 0;
    const bool there = size <= bytes.size() - at;
    return there && u32(bytes, at + size - 4) != size ? 0 : size;  // stands at both ends of a block
  }
  const std::int64_t seconds = std::int64_t{u32(bytes, at)} - last_ns_ / ns_per_s;
  const std::uint32_t fractions = nanoseconds_ ? 1'000'000'000 : 1'000'000;
  const std::uint32_t captured = u32(bytes, at + 8);
  const bool likely = std::abs(seconds) < longest_capture_s && u32(bytes, at + 4) < fractions &&
                      captured <= u32(bytes, at + 12) && captured <= most_frame_bytes;
  return likely ? most_head + captured : 0;
}

bool PacketCapture::frames_follow(Bytes bytes, std::size_t at) const {
  constexpr std::size_t enough = 4;  // that come to stand behind each other by chance
  for (std::size_t frames = 0;; ++frames) {
    const std::uint64_t size = frame_size(bytes, at);
    if (size == 0) return frames >= enough && bytes.size() - at < 16;
    if (size >= bytes.size() - at) return frames >= enough;
    at += static_cast<std::size_t>(size);
  }
}

bool PacketCapture::jump_near_end(std::uint64_t most_bytes) {
  std::uint64_t begin = file_.size() > most_bytes ? file_.size() - most_bytes : 0;
  begin -= begin % 4;  // where blocks of pcapng begin
  if (begin <= offset_) return true;
  std::vector<std::byte> buffer;
  const Bytes tail = file_.read(begin, file_.size() - begin, buffer);
  for (std::size_t at = 0; at < std::min<std::size_t>(tail.size(), most_frame_bytes);
       at += next_generation_ ? 4 : 1) {
    if (!frames_follow(tail, at)) continue;
    offset_ = begin + at;
    return true;
  }
  return false;
}

bool PacketCapture::next(Datagram& datagram) {
  try {
    while (!ended_) {
      const auto frame = next_generation_ ? next_block() : next_pcap_frame();
      if (!frame) continue;
      last_ns_ = frame->received_ns;
      const auto found =
          finder_.add(frame->bytes, frame->link_type, frame->received_ns, frame->whole);
      if (!found) continue;
      datagram = *found;
      return true;
    }
  } catch (const Refusal& refusal) {
    ended_ = true;
    damage_ = ContainerDamage{refusal.reason(),
                              file_.path().string() + ": at byte " + std::to_string(offset_) +
                                  ": " + refusal.what() + "; what came before is read"};
  }
  return false;
}

}  // namespace kissmap
