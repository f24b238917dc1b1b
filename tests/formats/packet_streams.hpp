// SPDX-License-Identifier: MIT
// Some turns of every kind of sensor whose packets are read, at random: shots without a return,
// columns and a whole turn in which nothing comes back, returns that repeat.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "formats/hdl_64e_unit.hpp"
#include "formats/hesai_packets.hpp"
#include "formats/ouster_packets.hpp"
#include "formats/packet_bag.hpp"
#include "formats/sensors/hdl_64e_decoder.hpp"
#include "formats/sensors/hesai_decoder.hpp"
#include "formats/sensors/ouster_decoder.hpp"
#include "formats/sensors/velodyne_decoder.hpp"

namespace kissmap::test {

struct PacketStream {
  std::string name;
  SensorFamily family = SensorFamily::velodyne;
  std::function<std::unique_ptr<PacketDecoder>()> make;
  std::size_t column_returns = 0;  ///< most of one column
  std::vector<RecordedPacket> packets;
  std::string calibration;  ///< what its file has
};

inline constexpr std::int64_t stream_start_ns = 1'700'000'000'000'000'000;  // 800 s past an hour
inline constexpr long turn_steps = 36'000;
inline constexpr long turns = 5;
inline constexpr long silent_turn = 2;

/// Distances of one stream.
class RandomShots {
 public:
  /// Begins a column, `steps` after the first of all.
  void column(long steps) { silent_ = steps / turn_steps == silent_turn || random_() % 8 == 0; }
  unsigned distance() {
    if (silent_ || random_() % 4 == 0) return 0;
    if (random_() % 4 != 0) before_ = 500 + static_cast<unsigned>(random_() % 20'000);
    return before_;
  }
  unsigned any() { return static_cast<unsigned>(random_()); }

 private:
  std::mt19937 random_{1};
  bool silent_ = false;
  unsigned before_ = 500;
};

struct VelodyneKind {
  std::string name;
  unsigned product, mode;
  std::size_t banks;  ///< of 32 lasers
  long steps;         ///< from column to column
  double column_us;
};

inline PacketStream velodyne_stream(const VelodyneKind& kind) {
  constexpr unsigned bank_marks[] = {0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF};
  const std::size_t returns = kind.mode == 0x39 ? 2 : 1;
  const std::size_t per_column = kind.banks * returns;
  PacketStream stream{
      kind.name, SensorFamily::velodyne, make_velodyne_decoder, 32 * per_column, {}, ""};
  RandomShots shots;
  double us = 0.0;
  for (long steps = 0; steps < turns * turn_steps;) {
    VelodynePacket packet(kind.product, kind.mode, 800'000'000 + static_cast<std::uint32_t>(us));
    for (std::size_t block = 0; block / per_column < 12 / per_column; ++block) {
      if (block % per_column == 0) shots.column(steps);
      packet.mark(block, bank_marks[block / returns % kind.banks]).azimuth(block, steps);
      for (std::size_t i = 0; i < 32; ++i) packet.shot(block, i, shots.distance(), shots.any());
      if (block % per_column == per_column - 1) {
        steps += kind.steps;
        us += kind.column_us;
      }
    }
    stream.packets.push_back({stream_start_ns + std::llround(us) * 1000, packet.bytes()});
  }
  return stream;
}

/// Of packets `packet_us` apart; without it of an S1, which does not tell the time.
inline PacketStream hdl_64e_stream(const std::string& name, std::uint32_t packet_us, bool dual) {
  constexpr long steps_a_column = 40;
  const Hdl64eCalibration unit = random_calibration(7);
  const std::size_t per_column = dual ? 4 : 2;
  PacketStream stream{name,
                      SensorFamily::velodyne,
                      [unit] { return make_hdl_64e_decoder(unit); },
                      32 * per_column,
                      {},
                      yaml_of(unit)};
  RandomShots shots;
  long steps = 0;
  for (std::uint32_t i = 0; steps < turns * turn_steps; ++i) {
    const std::uint32_t us = packet_us == 0 ? shots.any() : 800'000'000 + i * packet_us;
    VelodynePacket packet = hdl_64e_packet(us, steps, steps_a_column, per_column);
    for (std::size_t block = 0; block < VelodynePacket::blocks; ++block) {
      if (block % per_column == 0) shots.column(std::exchange(steps, steps + steps_a_column));
      for (std::size_t k = 0; k < 32; ++k) packet.shot(block, k, shots.distance(), shots.any());
    }
    const std::int64_t us_after = std::int64_t{i} * (packet_us == 0 ? 288 : packet_us);
    stream.packets.push_back({stream_start_ns + us_after * 1000, packet.bytes()});
  }
  return stream;
}

inline PacketStream hesai_stream(const HesaiKind& kind, unsigned mode, std::size_t returns) {
  constexpr long steps_a_column = 60;
  PacketStream stream{std::string(kind.sensor) + " of " + std::to_string(returns),
                      SensorFamily::hesai,
                      [] { return make_hesai_decoder({}); },
                      kind.lasers * returns,
                      {},
                      ""};
  RandomShots shots;
  long steps = 0;
  const std::int64_t packet_us = 166 * static_cast<std::int64_t>(kind.blocks / returns);
  for (std::int64_t us = 0; steps < turns * turn_steps; us += packet_us) {
    HesaiPacketBytes packet(kind, mode);
    packet.speed(600).microseconds(static_cast<unsigned long>(us));
    for (std::size_t block = 0; block < kind.blocks; ++block) {
      if (block % returns == 0) shots.column(steps);
      packet.azimuth(block, steps);
      for (std::size_t k = 0; k < kind.lasers; ++k) {
        packet.shot(block, k, shots.distance(), shots.any());
      }
      if (block % returns == returns - 1) steps += steps_a_column;
    }
    stream.packets.push_back({stream_start_ns + us * 1000, packet.bytes()});
  }
  return stream;
}

/// Every tenth packet comes late, some of them after the first of the next frame.
inline PacketStream ouster_stream(const std::string& profile) {
  constexpr std::size_t columns = 1024;
  const bool legacy = profile == "LEGACY";
  const std::size_t words = 2 * (legacy || !profile.ends_with("DUAL") ? 3 : 4);
  const std::string metadata = small_ouster(profile).dump();
  PacketStream stream{
      profile,
      SensorFamily::ouster,
      [metadata] { return make_ouster_decoder(read_ouster_metadata(metadata, "m.json")); },
      4,
      {},
      metadata};
  RandomShots shots;
  for (std::size_t first = 0; first < turns * columns; first += 16) {
    OusterPacketBytes packet(legacy, static_cast<std::uint16_t>(first / columns));
    for (std::size_t i = first; i < first + 16; ++i) {
      shots.column(static_cast<long>(i) * turn_steps / static_cast<long>(columns));
      std::vector<std::uint32_t> column(words);
      for (std::uint32_t& word : column) word = shots.distance();
      const auto after_ns = static_cast<std::int64_t>(i) * 97'000;
      packet.column(stream_start_ns + after_ns, i % columns, column, shots.any() % 16 != 0);
    }
    const std::string text = packet.text();
    const auto bytes = bytes_of(text);
    const auto us = static_cast<std::int64_t>(first) * 97;
    stream.packets.push_back({stream_start_ns + us * 1000, {bytes.begin(), bytes.end()}});
  }
  for (std::size_t i = 0; i + 3 < stream.packets.size(); i += 10) {
    std::swap(stream.packets[i].payload, stream.packets[i + 3].payload);
  }
  return stream;
}

inline constexpr std::size_t stream_count = 15;

inline PacketStream packet_stream(std::size_t number) {
  const std::array<std::function<PacketStream()>, stream_count> streams{
      [] {
        return velodyne_stream({"VLP-16", 0x22, 0x37, 1, 40, 110.592});
      },
      [] {
        return velodyne_stream({"VLP-16 dual", 0x22, 0x39, 1, 40, 110.592});
      },
      [] {
        return velodyne_stream({"HDL-32E", 0x21, 0x38, 1, 30, 46.08});
      },
      [] {
        return velodyne_stream({"VLS-128", 0xA1, 0x37, 4, 40, 53.3});
      },
      [] {
        return velodyne_stream({"VLS-128 dual", 0xA1, 0x39, 4, 45, 53.3});
      },
      [] { return hdl_64e_stream("HDL-64E S1", 0, false); },
      [] { return hdl_64e_stream("HDL-64E S2", 288, false); },
      [] { return hdl_64e_stream("HDL-64E S3 dual", 173, true); },
      [] { return hesai_stream(xt_32_kind, 0x37, 1); },
      [] { return hesai_stream(xt_32m_kind, 0x3D, 3); },
      [] { return hesai_stream(qt_128_kind, 0x39, 2); },
      [] { return hesai_stream(pandar_64_kind, 0x39, 2); },
      [] { return ouster_stream("LEGACY"); },
      [] { return ouster_stream("RNG19_RFL8_SIG16_NIR16"); },
      [] { return ouster_stream("RNG19_RFL8_SIG16_NIR16_DUAL"); }};
  return streams.at(number)();
}

}  // namespace kissmap::test
