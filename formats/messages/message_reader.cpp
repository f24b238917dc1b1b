// SPDX-License-Identifier: MIT
#include "formats/messages/message_reader.hpp"

namespace kissmap {
namespace {

constexpr std::size_t encapsulation_size = 4;

}  // namespace

MessageReader::MessageReader(std::span<const std::byte> message, MessageEncoding encoding)
    : bytes_(message), cdr_(encoding == MessageEncoding::cdr) {
  if (!cdr_) return;
  if (message.size() < encapsulation_size) {
    throw Refusal(refusal_reason::truncated, "a CDR message of less than 4 bytes");
  }
  const auto first = static_cast<int>(message[0]);
  const auto kind = static_cast<int>(message[1]);
  if (first != 0 || kind > 1) {
    throw Refusal(refusal_reason::unsupported,
                  "CDR encapsulation kind " + std::to_string(kind) +
                      " is not supported, plain CDR (0 and 1) is");
  }
  swap_ = kind == 0;
  bytes_ = message.subspan(encapsulation_size);
}

void MessageReader::align(std::size_t size) {
  if (!cdr_ || size < 2) return;
  const std::size_t beyond = position_ % size;
  if (beyond != 0) take(size - beyond);
}

std::span<const std::byte> MessageReader::take(std::uint64_t count) {
  if (count > left()) {
    throw Refusal(refusal_reason::truncated,
                  "a message of " + std::to_string(bytes_.size()) + " bytes wants " +
                      std::to_string(count) + " more at byte " + std::to_string(position_));
  }
  const auto taken = bytes_.subspan(position_, static_cast<std::size_t>(count));
  position_ += taken.size();
  return taken;
}

std::span<const std::byte> MessageReader::bytes() {
  return take(value<std::uint32_t>());
}

std::string_view MessageReader::text() {
  const auto raw = bytes();
  std::string_view text(reinterpret_cast<const char*>(raw.data()), raw.size());
  if (cdr_ && text.ends_with('\0')) text.remove_suffix(1);
  return text;
}

std::uint32_t MessageReader::length(std::size_t least_size) {
  const auto count = value<std::uint32_t>();
  if (count > left() / least_size) {
    throw Refusal(refusal_reason::truncated,
                  "a sequence of " + std::to_string(count) + " elements in the " +
                      std::to_string(left()) + " bytes that are left");
  }
  return count;
}

std::int64_t read_time(MessageReader& reader) {
  constexpr std::int64_t ns_per_s = 1'000'000'000;
  // Signed in ROS 2, unsigned in ROS 1; no clock has come to where that differs.
  const auto seconds = static_cast<std::int64_t>(reader.value<std::uint32_t>());
  return seconds * ns_per_s + static_cast<std::int64_t>(reader.value<std::uint32_t>());
}

MessageHeader read_header(MessageReader& reader) {
  if (!reader.is_cdr()) reader.value<std::uint32_t>();  // seq
  const std::int64_t stamp_ns = read_time(reader);
  return {stamp_ns, std::string(reader.text())};
}

}  // namespace kissmap
