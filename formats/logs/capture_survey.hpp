// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "formats/sensors/packet_decoder.hpp"
#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// A stream of datagrams: where they go, and how long they are.
struct DatagramStream {
  std::uint16_t port = 0;
  std::size_t size = 0;  ///< bytes
  friend auto operator<=>(const DatagramStream&, const DatagramStream&) = default;
};

/// Sentences of a satellite receiver, which Velodyne's position packets and Hesai's GPS packets
/// hold.
struct NmeaCount {
  std::uint64_t sentences = 0;
  std::uint64_t with_fix = 0;
};

/// What the first part of a capture holds, by port.
struct CaptureSurvey {
  std::map<DatagramStream, std::uint64_t> streams;  ///< how many datagrams
  std::map<std::uint16_t, SensorFamily> marked;     ///< sensors whose packets have a mark
  std::map<std::uint16_t, std::string> foreign;     ///< sensors that are not read: what to say
  std::map<std::uint16_t, NmeaCount> nmea;
  std::map<std::uint16_t, std::int64_t> first_ns;  ///< when the first was received
};

/// Looks at the first 20,000 datagrams of a capture, or at 24 MiB of them. Throws Error(input).
CaptureSurvey survey_capture(const std::filesystem::path& path);

/// The streams, one a line.
std::string listed(const CaptureSurvey& survey);

/// What goes to each port, as far as it is understood.
std::vector<LogTopic> topics_of(const CaptureSurvey& survey);

/// When the last datagram to a port was received [ns], if one lies within the last 4 MiB of the
/// file.
std::optional<std::int64_t> last_received(const std::filesystem::path& path, std::uint16_t port);

}  // namespace kissmap
