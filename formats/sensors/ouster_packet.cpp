// SPDX-License-Identifier: MIT
#include "formats/sensors/ouster_packet.hpp"

#include <algorithm>
#include <cstring>
#include <string>

#include "formats/clouds/refusal.hpp"

namespace kissmap {
namespace {

constexpr OusterField none{};

constexpr OusterProfile profiles[] = {
    {"LEGACY", 12, 1, {{0, 20}, none}, {{48, 16}, none}, {{32, 8}, none}, {64, 16}},
    {"RNG19_RFL8_SIG16_NIR16", 12, 1, {{0, 19}, none}, {{48, 16}, none}, {{32, 8}, none}, {64, 16}},
    {"RNG19_RFL8_SIG16_NIR16_DUAL",
     16,
     1,
     {{0, 19}, {32, 19}},
     {{64, 16}, {80, 16}},
     {{24, 8}, {56, 8}},
     {96, 16}},
    {"RNG15_RFL8_NIR8", 4, 8, {{0, 15}, none}, {none, none}, {{16, 8}, none}, {24, 8}},
    {"RNG15_RFL8_NIR8_DUAL", 8, 8, {{0, 15}, {32, 15}}, {none, none}, {{16, 8}, {48, 8}}, {24, 8}},
    {"FIVE_WORD_PIXEL",
     20,
     1,
     {{0, 19}, {32, 19}},
     {{64, 16}, {80, 16}},
     {{24, 8}, {56, 8}},
     {96, 16}}};

template <class T>
T at(std::span<const std::byte> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.subspan(offset, sizeof(T)).data(), sizeof(T));
  return value;
}

}  // namespace

const OusterProfile& ouster_profile(std::string_view name) {
  const auto* found = std::ranges::find(profiles, name, &OusterProfile::name);
  // Its first name.
  if (name == "RNG19_RFL8_SIG16_NIR16_SINGLE") found = &profiles[1];
  if (found != std::end(profiles)) return *found;
  std::string known;
  for (const OusterProfile& profile : profiles) known += " " + std::string(profile.name);
  throw Refusal(refusal_reason::unsupported,
                "Ouster packets of profile " + std::string(name.substr(0, 60)) +
                    " are not read; known are:" + known);
}

OusterPackets::OusterPackets(const OusterMetadata& about)
    : profile_(ouster_profile(about.profile)),
      beams_(about.beams),
      columns_(about.columns_per_packet) {
}

std::size_t OusterPackets::column_bytes() const {
  return column_header_bytes() + beams_ * profile_.pixel_bytes + (legacy() ? 4 : 0);
}

std::size_t OusterPackets::packet_bytes() const {
  return 2 * header_bytes() + columns_ * column_bytes();
}

std::optional<std::uint32_t> OusterPackets::initialization_id(
    std::span<const std::byte> packet) const {
  if (legacy()) return std::nullopt;
  return at<std::uint32_t>(packet, 4) & 0xFFFFFFU;
}

OusterColumn OusterPackets::column(std::span<const std::byte> packet, std::size_t index) const {
  const auto bytes = packet.subspan(header_bytes() + index * column_bytes(), column_bytes());
  OusterColumn column;
  column.timestamp_ns = at<std::uint64_t>(bytes, 0);
  column.measurement_id = at<std::uint16_t>(bytes, 8);
  column.pixels = bytes.subspan(column_header_bytes(), beams_ * profile_.pixel_bytes);
  if (legacy()) {
    column.frame_id = at<std::uint16_t>(bytes, 10);
    column.status = at<std::uint32_t>(bytes, bytes.size() - 4);
    column.valid = column.status == 0xFFFFFFFFU;
  } else {
    column.frame_id = at<std::uint16_t>(packet, 2);
    column.status = at<std::uint16_t>(bytes, 10);
    column.valid = (column.status & 1U) != 0;
  }
  return column;
}

std::uint64_t OusterPackets::read(std::span<const std::byte> pixel, OusterField field) {
  std::uint64_t word = 0;
  const std::size_t begin = field.offset / 8;
  const std::size_t count = std::min<std::size_t>(8, pixel.size() - begin);
  std::memcpy(&word, pixel.data() + begin, count);
  return (word >> (field.offset % 8)) & ((std::uint64_t{1} << field.width) - 1);
}

}  // namespace kissmap
