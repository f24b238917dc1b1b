// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>

#include "kissmap/cloud/scan.hpp"

namespace kissmap {

/// Whose packets.
enum class SensorFamily : std::uint8_t { velodyne, hesai, ouster };

/// What became of the payloads a decoder was given.
struct PacketCounts {
  std::uint64_t decoded = 0;
  std::uint64_t foreign = 0;  ///< another size or mark than the sensor's: other traffic on the port
  std::uint64_t damaged = 0;  ///< the sensor's by its size, but not by its content
};

/// Turns the data packets of one sensor into sweeps. Points are in the sensor's own frame with x
/// forward, y left, z up where its maker does not define another [m]; a shot that nothing came
/// back of gives its direction (Scan::no_return_directions) and no point. Stamps are those of the
/// first point of a sweep (sweep_start), times relative to it recorded, compensation none. Not
/// thread safe.
class PacketDecoder {
 public:
  virtual ~PacketDecoder() = default;

  /// One UDP payload, in recorded order. `host_ns` is when it was received, ns since 1970.
  /// A payload that is none of the sensor's is counted and otherwise ignored. Throws Refusal only
  /// for a sensor, mode or profile that is not supported, naming it.
  virtual void add(std::span<const std::byte> payload, std::int64_t host_ns) = 0;

  /// The oldest complete sweep; nothing while none is complete.
  std::optional<Scan> take();

  /// Of the next `sweeps` sweeps, those that are not complete yet are only counted: take() gives
  /// each as soon as ever, but as a rule with no more than the points of one column. All that
  /// follows is as if they had been decoded. Replaces what was said before, so that 0 ends it; of a
  /// sweep that is begun and no longer passed over nothing is missing.
  void pass(std::size_t sweeps);

  /// No more payloads come: what was begun becomes the last sweep, unless it is empty.
  virtual void finish() = 0;

  /// The sensor, as its maker names it, once known: "Velodyne VLP-16".
  virtual std::string sensor() const = 0;

  const PacketCounts& counts() const { return counts_; }

 protected:
  /// The same, of sweeps that are not complete.
  virtual void pass_incomplete(std::size_t sweeps) = 0;

  std::deque<Scan> sweeps_;
  PacketCounts counts_;
};

}  // namespace kissmap
