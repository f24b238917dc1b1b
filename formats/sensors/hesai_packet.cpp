// SPDX-License-Identifier: MIT
// Layout of packets: the maker's HesaiLidar_SDK_2.0 (libhesai/UdpProtocol: protocols 6.1, 3.2 and
// those of the Pandar64 and the Pandar40P, which have no version).
#include "formats/sensors/hesai_packet.hpp"

#include <chrono>
#include <string>

#include "formats/clouds/refusal.hpp"
#include "formats/sensors/foreign_sensor.hpp"

namespace kissmap {
namespace {

constexpr std::uint16_t mark = 0xFFEE;        // bytes EE FF
constexpr std::uint16_t block_mark = 0xEEFF;  // of the Pandar40P, which has no header
constexpr std::uint8_t xt_major = 6;
constexpr std::uint8_t xt_minor = 1;
constexpr std::uint8_t qt_major = 3;
constexpr std::uint8_t qt_minor = 2;
constexpr std::size_t versioned_header = 12;
constexpr std::size_t pandar_64_header = 8;
constexpr std::size_t sequence_number = 4;
constexpr std::size_t checksum = 4;
constexpr std::size_t functional_safety = 17;
constexpr std::size_t signature = 32;
constexpr std::size_t xt_tail = 24;
constexpr std::size_t qt_tail = 26;
constexpr std::size_t pandar_tail = 22;
constexpr std::size_t pandar_40p_size = 1262;
constexpr double m_per_mm = 0.001;

// Bits of the last byte of a versioned header.
constexpr unsigned has_sequence = 1;
constexpr unsigned has_functional_safety = 4;
constexpr unsigned has_signature = 8;
constexpr unsigned has_confidence = 16;
constexpr unsigned has_own_channels = 64;

[[noreturn]] void refuse(const std::string& what) {
  throw Refusal(refusal_reason::wrong_kind, what);
}

std::size_t returns_of(std::uint8_t mode, const HesaiModel& model) {
  std::size_t returns = 0;
  if (mode == 0x33 || mode == 0x34 || mode == 0x37 || mode == 0x38) returns = 1;
  if ((mode >= 0x39 && mode <= 0x3C) || mode == 0x3E) returns = 2;
  if (mode == 0x3D) returns = 3;
  if (returns == 0 || model.blocks % returns != 0) {
    refuse(std::string(model.name) + " in the unsupported return mode " + std::to_string(mode));
  }
  return returns;
}

std::int64_t date_ns(const PacketBytes& bytes, std::size_t at, bool may_be_unix) {
  namespace chrono = std::chrono;
  constexpr unsigned century = 100;
  constexpr unsigned before_1970 = 70;
  const unsigned year = bytes.u8(at);
  if (may_be_unix && year == 0) return bytes.u32_big(at + 2) * std::int64_t{1'000'000'000};
  const chrono::year_month_day date{
      chrono::year(static_cast<int>(1900 + year + (year < before_1970 ? century : 0))),
      chrono::month(bytes.u8(at + 1)),
      chrono::day(bytes.u8(at + 2))};
  // A clock that was never set may count from a day that is none.
  chrono::nanoseconds since_1970{};
  if (date.ok()) since_1970 = chrono::sys_days(date).time_since_epoch();
  return (since_1970 + chrono::hours(bytes.u8(at + 3)) + chrono::minutes(bytes.u8(at + 4)) +
          chrono::seconds(bytes.u8(at + 5)))
      .count();
}

std::int64_t ns_of_us(std::uint32_t us) {
  return us * std::int64_t{1000};
}

struct TailPlaces {
  std::size_t mode = 0;
  std::size_t speed = 0;
  std::size_t date = 0;
  std::size_t microseconds = 0;
  bool may_be_unix = true;
};
constexpr TailPlaces xt_places{10, 11, 13, 19, true};
constexpr TailPlaces qt_places{12, 13, 15, 21, true};
constexpr std::size_t qt_order_at = 5;
constexpr TailPlaces pandar_places{14, 8, 16, 10, false};

void read_tail(const PacketBytes& bytes,
               std::size_t tail,
               const TailPlaces& places,
               const HesaiModel& model,
               HesaiPacket& packet) {
  packet.returns = returns_of(bytes.u8(tail + places.mode), model);
  packet.turns_per_minute = bytes.u16(tail + places.speed);
  packet.time_ns = date_ns(bytes, tail + places.date, places.may_be_unix) +
                   ns_of_us(bytes.u32(tail + places.microseconds));
}

std::optional<HesaiPacket> read_xt(const PacketBytes& bytes, const HesaiModel& model) {
  HesaiPacket packet;
  packet.first_block_at = versioned_header;
  packet.shot_size = 4;
  packet.block_size = 2 + packet.shot_size * model.lasers;
  const std::size_t tail = packet.block_start(model.blocks);
  const unsigned flags = bytes.u8(11);
  if (bytes.size() < tail + xt_tail + (flags & has_sequence ? sequence_number : 0)) return {};
  packet.unit_m = bytes.u8(9) * m_per_mm;
  read_tail(bytes, tail, xt_places, model, packet);
  return packet;
}

std::optional<HesaiPacket> read_qt(const PacketBytes& bytes, const HesaiModel& model) {
  HesaiPacket packet;
  const unsigned flags = bytes.u8(11);
  packet.first_block_at = versioned_header;
  packet.shot_size = flags & has_confidence ? 4 : 3;
  packet.block_size = 2 + packet.shot_size * model.lasers;
  const std::size_t tail = packet.block_start(model.blocks) + checksum +
                           (flags & has_functional_safety ? functional_safety : 0);
  const std::size_t size = tail + qt_tail + (flags & has_sequence ? sequence_number : 0) +
                           checksum + (flags & has_signature ? signature : 0);
  if (bytes.size() < size) return {};
  if (flags & has_own_channels) {
    refuse(std::string(model.name) + " with an order of channels of its own");
  }
  packet.unit_m = bytes.u8(9) * m_per_mm;
  packet.first_order = (bytes.u8(tail + qt_order_at) + 1U) % 2U;
  read_tail(bytes, tail, qt_places, model, packet);
  return packet;
}

// The Pandar64 has a header, the Pandar40P a mark in every block and always 4 mm.
std::optional<HesaiPacket> read_pandar(const PacketBytes& bytes, const HesaiModel& model) {
  const bool headed = &model == &hesai::pandar_64;
  HesaiPacket packet;
  packet.first_block_at = headed ? pandar_64_header : 0;
  packet.azimuth_at = headed ? 0 : 2;
  packet.shot_size = 3;
  packet.block_size = packet.azimuth_at + 2 + packet.shot_size * model.lasers;
  const std::size_t tail = packet.block_start(model.blocks);
  if (bytes.size() != tail + pandar_tail && bytes.size() != tail + pandar_tail + sequence_number) {
    return {};
  }
  for (std::size_t block = 0; !headed && block < model.blocks; ++block) {
    if (bytes.u16(packet.block_start(block)) != block_mark) return {};
  }
  constexpr unsigned pandar_40p_mm = 4;
  packet.unit_m = (headed ? bytes.u8(5) : pandar_40p_mm) * m_per_mm;
  read_tail(bytes, tail, pandar_places, model, packet);
  return packet;
}

const HesaiModel* recognize_version(const PacketBytes& bytes, unsigned major, unsigned minor) {
  const bool xt = major == xt_major && minor == xt_minor;
  const bool qt = major == qt_major && minor == qt_minor;
  const unsigned lasers = bytes.u8(6);
  const unsigned blocks = bytes.u8(7);
  const auto is = [&](const HesaiModel& model) {
    return model.lasers == lasers && model.blocks == blocks;
  };
  if (qt && is(hesai::qt_128)) return &hesai::qt_128;
  if (xt && is(hesai::xt_32)) return &hesai::xt_32;
  if (xt && is(hesai::xt_16)) return &hesai::xt_16;
  if (xt && is(hesai::xt_32m)) return &hesai::xt_32m;
  refuse(describe_unread_hesai({major, minor, lasers, blocks}));
}

}  // namespace

const HesaiModel* recognize_hesai(const PacketBytes& bytes) {
  if (bytes.size() < versioned_header) return nullptr;
  if (bytes.u16(0) == block_mark) {
    const bool fits =
        bytes.size() == pandar_40p_size || bytes.size() == pandar_40p_size + sequence_number;
    return fits ? &hesai::pandar_40p : nullptr;
  }
  if (bytes.u16(0) != mark) return nullptr;
  const unsigned lasers = bytes.u8(2);
  const unsigned blocks = bytes.u8(3);
  if (lasers == hesai::pandar_64.lasers && blocks == hesai::pandar_64.blocks) {
    return &hesai::pandar_64;
  }
  return recognize_version(bytes, lasers, blocks);
}

std::optional<HesaiPacket> read_hesai_packet(const PacketBytes& bytes, const HesaiModel& model) {
  if (&model == &hesai::qt_128) return read_qt(bytes, model);
  if (&model == &hesai::pandar_64 || &model == &hesai::pandar_40p) {
    return read_pandar(bytes, model);
  }
  return read_xt(bytes, model);
}

}  // namespace kissmap
