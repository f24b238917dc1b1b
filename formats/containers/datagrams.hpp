// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <optional>
#include <span>
#include <vector>

namespace kissmap {

/// A UDP datagram. `payload` is valid until the next one is asked for.
struct Datagram {
  std::int64_t received_ns = 0;  ///< since 1970
  std::uint16_t source_port = 0;
  std::uint16_t destination_port = 0;
  std::span<const std::byte> payload;
};

/// What of a capture was passed over, by cause.
struct PassedOver {
  std::uint64_t not_udp = 0;     ///< other protocols
  std::uint64_t cut_short = 0;   ///< the capture kept a part of the packet only
  std::uint64_t malformed = 0;   ///< lengths that contradict each other
  std::uint64_t incomplete = 0;  ///< fragments of which others are missing
};

/// Finds UDP datagrams in captured frames and puts fragments together. Sources: RFC 791 (IPv4),
/// 8200 (IPv6), 768 (UDP); tcpdump.org/linktypes.html. Memory: 64 datagrams at most. Not thread
/// safe.
class DatagramFinder {
 public:
  /// The UDP datagram that this frame is or completes, if any; its payload points into the frame or
  /// into this object. `whole` tells that no byte of the frame was left out.
  std::optional<Datagram> add(std::span<const std::byte> frame,
                              std::uint32_t link_type,
                              std::int64_t received_ns,
                              bool whole);

  const PassedOver& passed_over() const { return passed_over_; }

 private:
  using Key = std::array<std::byte, 37>;  // addresses, protocol, identification
  struct Fragments {
    Key key;
    std::vector<std::byte> bytes;
    std::vector<bool> there;  ///< by units of 8 bytes
    std::optional<std::size_t> size;
  };
  struct Piece {
    Key key;
    std::size_t offset = 0;
    bool more = false;
    std::span<const std::byte> bytes;
  };

  std::optional<std::span<const std::byte>> read_ipv4(std::span<const std::byte> packet);
  std::optional<std::span<const std::byte>> read_ipv6(std::span<const std::byte> packet);
  std::optional<std::span<const std::byte>> put_together(const Piece& piece);

  PassedOver passed_over_;
  std::list<Fragments> open_;
  std::vector<std::byte> complete_;
};

}  // namespace kissmap
