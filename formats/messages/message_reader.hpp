// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "formats/clouds/gather.hpp"
#include "formats/clouds/refusal.hpp"
#include "formats/containers/message_source.hpp"

namespace kissmap {

/// Reads the members of a ROS message one after the other, as ROS 1 or as ROS 2 (plain CDR, both
/// byte orders) serialise them. Every member throws Refusal where the message ends.
/// Sources: wiki.ros.org/msg (serialisation), OMG DDSI-RTPS 2.2 chapter 10 (CDR encapsulation).
class MessageReader {
 public:
  /// Throws Refusal for an encapsulation that is not plain CDR.
  MessageReader(std::span<const std::byte> message, MessageEncoding encoding);

  bool is_cdr() const { return cdr_; }
  std::size_t position() const { return position_; }
  std::size_t left() const { return bytes_.size() - position_; }
  std::endian byte_order() const { return swap_ ? std::endian::big : std::endian::little; }

  template <class T>
  requires std::is_arithmetic_v<T> T value() {
    align(sizeof(T));
    return gather_detail::load<T>(take(sizeof(T)).data(), swap_);
  }

  std::string_view text();
  /// A sequence of bytes with its length before it.
  std::span<const std::byte> bytes();
  std::span<const std::byte> take(std::uint64_t count);

  /// The length of a sequence whose elements take `least_size` bytes or more each.
  std::uint32_t length(std::size_t least_size);

  /// In CDR the place of a value is a multiple of its size, from the message's start.
  void align(std::size_t size);

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  bool cdr_ = false;
  bool swap_ = false;
};

/// std_msgs/Header.
struct MessageHeader {
  std::int64_t stamp_ns = 0;
  std::string frame;
};
MessageHeader read_header(MessageReader& reader);

/// A time as ROS writes it: seconds, then nanoseconds, 32 bits each.
std::int64_t read_time(MessageReader& reader);

}  // namespace kissmap
