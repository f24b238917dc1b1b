// SPDX-License-Identifier: MIT
#include "formats/containers/datagrams.hpp"

#include <algorithm>
#include <utility>

namespace kissmap {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::size_t most_open = 64;
constexpr std::size_t most_bytes = 65535;  // of a datagram
constexpr std::size_t unit = 8;            // bytes, in which fragments are counted
constexpr std::uint8_t udp = 17;
constexpr std::uint8_t ipv6_fragment = 44;
constexpr std::uint16_t type_ipv4 = 0x0800;
constexpr std::uint16_t type_ipv6 = 0x86DD;
constexpr std::uint16_t type_vlan = 0x8100;
constexpr std::uint16_t type_service_vlan = 0x88A8;

std::uint8_t u8(Bytes bytes, std::size_t at) {
  return std::to_integer<std::uint8_t>(bytes[at]);
}
std::uint16_t u16(Bytes bytes, std::size_t at) {
  return static_cast<std::uint16_t>((u8(bytes, at) << 8U) | u8(bytes, at + 1));
}

/// The packet inside of a frame; nothing where the frame is too short or of no known kind.
std::optional<Bytes> after_type(Bytes frame, std::size_t type_at) {
  if (frame.size() < type_at + 2) return std::nullopt;
  std::uint16_t type = u16(frame, type_at);
  std::size_t at = type_at + 2;
  while ((type == type_vlan || type == type_service_vlan) && frame.size() >= at + 4) {
    type = u16(frame, at + 2);
    at += 4;
  }
  if (type != type_ipv4 && type != type_ipv6) return std::nullopt;
  return frame.subspan(at);
}

std::optional<Bytes> ip_packet(Bytes frame, std::uint32_t link_type) {
  switch (link_type) {
    case 1:  // Ethernet
      return after_type(frame, 12);
    case 113:  // Linux cooked
      return after_type(frame, 14);
    case 276:  // Linux cooked, version 2: the type stands at the front
      if (frame.size() < 20 || (u16(frame, 0) != type_ipv4 && u16(frame, 0) != type_ipv6)) {
        return std::nullopt;
      }
      return frame.subspan(20);
    case 0:    // loopback
    case 108:  // loopback of OpenBSD
      return frame.size() < 4 ? std::nullopt : std::optional(frame.subspan(4));
    case 12:   // raw IP, as some systems number it
    case 101:  // raw IP
    case 228:  // IPv4
    case 229:  // IPv6
      return frame;
    default:
      return std::nullopt;
  }
}

template <class Key>
Key key_of(Bytes addresses, Bytes identification) {
  Key key{};
  std::ranges::copy(addresses, key.begin());
  std::ranges::copy(identification, key.begin() + 32);
  return key;
}

}  // namespace

std::optional<Bytes> DatagramFinder::put_together(const Piece& piece) {
  auto place = std::ranges::find(open_, piece.key, &Fragments::key);
  if (place == open_.end()) {
    if (open_.size() >= most_open) {
      ++passed_over_.incomplete;
      open_.pop_front();
    }
    open_.push_back({piece.key, {}, {}, {}});
    place = std::prev(open_.end());
  }
  const std::size_t end = piece.offset + piece.bytes.size();
  if (end > most_bytes || (piece.more && piece.bytes.size() % unit != 0)) {
    ++passed_over_.malformed;
    return std::nullopt;
  }
  if (place->bytes.size() < end) place->bytes.resize(end);
  place->there.resize((place->bytes.size() + unit - 1) / unit);
  std::ranges::copy(piece.bytes, place->bytes.begin() + static_cast<std::ptrdiff_t>(piece.offset));
  for (std::size_t i = piece.offset / unit; i * unit < end; ++i) place->there[i] = true;
  if (!piece.more) place->size = end;
  const bool complete = place->size && place->bytes.size() == *place->size &&
                        std::ranges::find(place->there, false) == place->there.end();
  if (!complete) return std::nullopt;
  complete_ = std::move(place->bytes);
  open_.erase(place);
  return Bytes(complete_);
}

std::optional<Bytes> DatagramFinder::read_ipv4(Bytes packet) {
  const std::size_t header = std::size_t{u8(packet, 0) & 15U} * 4;
  if (packet.size() < 20 || header < 20 || header > packet.size()) {
    ++passed_over_.malformed;
    return std::nullopt;
  }
  // A frame may be padded; a length of 0 stands for the frame's where the network card cuts it.
  const std::size_t told = u16(packet, 2);
  const std::size_t size = told == 0 ? packet.size() : told;
  if (size < header || size > packet.size()) {
    ++passed_over_.malformed;
    return std::nullopt;
  }
  if (u8(packet, 9) != udp) {
    ++passed_over_.not_udp;
    return std::nullopt;
  }
  const std::uint16_t place = u16(packet, 6);
  const Bytes content = packet.subspan(header, size - header);
  const bool more = (place & 0x2000U) != 0;
  const std::size_t offset = std::size_t{place & 0x1FFFU} * unit;
  if (!more && offset == 0) return content;
  return put_together(
      {key_of<Key>(packet.subspan(12, 8), packet.subspan(4, 2)), offset, more, content});
}

std::optional<Bytes> DatagramFinder::read_ipv6(Bytes packet) {
  constexpr std::size_t header = 40;
  if (packet.size() < header || u16(packet, 4) > packet.size() - header) {
    ++passed_over_.malformed;
    return std::nullopt;
  }
  const std::uint8_t next = u8(packet, 6);
  const Bytes content = packet.subspan(header, u16(packet, 4));
  if (next == udp) return content;
  if (next != ipv6_fragment || content.size() < unit || u8(content, 0) != udp) {
    ++passed_over_.not_udp;
    return std::nullopt;
  }
  const std::uint16_t place = u16(content, 2);
  return put_together({key_of<Key>(packet.subspan(8, 32), content.subspan(4, 4)),
                       std::size_t{place & 0xFFF8U},
                       (place & 1U) != 0,
                       content.subspan(unit)});
}

std::optional<Datagram> DatagramFinder::add(Bytes frame,
                                            std::uint32_t link_type,
                                            std::int64_t received_ns,
                                            bool whole) {
  const auto packet = ip_packet(frame, link_type);
  if (!packet || packet->empty()) {
    ++passed_over_.not_udp;
    return std::nullopt;
  }
  if (!whole) {
    ++passed_over_.cut_short;
    return std::nullopt;
  }
  const unsigned version = u8(*packet, 0) >> 4U;
  if (version != 4 && version != 6) {
    ++passed_over_.not_udp;
    return std::nullopt;
  }
  const auto content = version == 4 ? read_ipv4(*packet) : read_ipv6(*packet);
  if (!content) return std::nullopt;
  constexpr std::size_t header = 8;
  if (content->size() < header || u16(*content, 4) < header || u16(*content, 4) > content->size()) {
    ++passed_over_.malformed;
    return std::nullopt;
  }
  return Datagram{received_ns,
                  u16(*content, 0),
                  u16(*content, 2),
                  content->subspan(header, u16(*content, 4) - header)};
}

}  // namespace kissmap
