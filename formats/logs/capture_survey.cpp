// SPDX-License-Identifier: MIT
// Sentences of satellite receivers: NMEA 0183 (RMC, GGA); where they stand in a packet differs.
#include "formats/logs/capture_survey.hpp"

#include <algorithm>
#include <string_view>

#include "formats/containers/packet_capture.hpp"
#include "formats/sensors/foreign_sensor.hpp"
#include "formats/text/lines.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_datagrams = 20'000;
constexpr std::size_t most_bytes = 24 << 20;
constexpr std::uint64_t tail_bytes = 4 << 20;
constexpr std::size_t velodyne_size = 1206;
constexpr std::size_t least_hesai_size = 500;
constexpr std::size_t gps_packet_size = 512;

bool begins_with(std::span<const std::byte> payload, int first, int second) {
  return payload.size() > 2 && payload[0] == std::byte(first) && payload[1] == std::byte(second);
}

/// By the marks packets begin with; Ouster's have none.
std::optional<SensorFamily> family_by_mark(std::span<const std::byte> payload) {
  if (payload.size() == velodyne_size && begins_with(payload, 0xFF, 0xEE))
    return SensorFamily::velodyne;
  if (payload.size() >= least_hesai_size && begins_with(payload, 0xEE, 0xFF))
    return SensorFamily::hesai;
  return std::nullopt;
}

std::string_view field_of(std::string_view sentence, std::size_t number) {
  for (; number > 0; --number) {
    const std::size_t comma = sentence.find(',');
    if (comma == std::string_view::npos) return {};
    sentence.remove_prefix(comma + 1);
  }
  return sentence.substr(0, sentence.find(','));
}

// "$GPRMC,time,A,..." or "$GNGGA,time,lat,N,lon,E,1,...".
void count_nmea(std::span<const std::byte> payload, NmeaCount& count) {
  const std::string_view text = text_of(payload);
  const std::size_t begin = text.find("$G");
  if (begin == std::string_view::npos) return;
  const std::string_view sentence = text.substr(begin);
  const std::string_view name = field_of(sentence, 0);
  if (name.size() != 6 || (!name.ends_with("RMC") && !name.ends_with("GGA"))) return;
  const bool fix = name.ends_with("RMC")
                       ? field_of(sentence, 2) == "A"
                       : !field_of(sentence, 6).empty() && field_of(sentence, 6) != "0";
  ++count.sentences;
  if (fix) ++count.with_fix;
}

/// Foreign sensors with how many of the datagrams to their port are theirs: an Ouster's packets
/// begin with a time, which may look like a mark once.
struct Foreign {
  std::string description;
  std::uint64_t count = 0;
};

void keep_certain(const std::map<std::uint16_t, Foreign>& found, CaptureSurvey& survey) {
  for (const auto& [port, foreign] : found) {
    std::uint64_t all = 0;
    for (const auto& [stream, count] : survey.streams) {
      if (stream.port == port) all += count;
    }
    if (2 * foreign.count >= all) survey.foreign.emplace(port, foreign.description);
  }
}

}  // namespace

CaptureSurvey survey_capture(const fs::path& path) {
  CaptureSurvey survey;
  std::map<std::uint16_t, Foreign> foreign;
  PacketCapture capture(path);
  Datagram datagram;
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < most_datagrams && bytes < most_bytes && capture.next(datagram); ++i) {
    const std::uint16_t port = datagram.destination_port;
    bytes += datagram.payload.size();
    ++survey.streams[{port, datagram.payload.size()}];
    survey.first_ns.emplace(port, datagram.received_ns);
    if (datagram.payload.size() == gps_packet_size) {
      count_nmea(datagram.payload, survey.nmea[port]);
    } else if (const auto family = family_by_mark(datagram.payload)) {
      survey.marked.emplace(port, *family);
    } else if (const auto description = describe_foreign_sensor(datagram.payload)) {
      Foreign& there = foreign[port];
      there.description = *description;
      ++there.count;
    }
  }
  keep_certain(foreign, survey);
  std::erase_if(survey.nmea, [](const auto& entry) { return entry.second.sentences == 0; });
  return survey;
}

std::string listed(const CaptureSurvey& survey) {
  std::string text;
  for (const auto& [stream, count] : survey.streams) {
    text += "\n  to port " + std::to_string(stream.port) + ", " + std::to_string(stream.size) +
            " bytes: " + std::to_string(count);
  }
  return text.empty() ? " none" : text;
}

std::vector<LogTopic> topics_of(const CaptureSurvey& survey) {
  std::vector<LogTopic> topics;
  for (const auto& [port, family] : survey.marked) {
    const char* maker = family == SensorFamily::velodyne ? "Velodyne" : "Hesai";
    topics.push_back({std::to_string(port), std::string(maker) + " packets", std::nullopt});
  }
  for (const auto& [port, count] : survey.nmea) {
    topics.push_back({std::to_string(port),
                      count.with_fix > 0 ? "NMEA sentences" : "NMEA sentences without a fix",
                      std::nullopt});
  }
  return topics;
}

std::optional<std::int64_t> last_received(const fs::path& path, std::uint16_t port) {
  PacketCapture capture(path);
  Datagram datagram;
  if (!capture.next(datagram) || !capture.jump_near_end(tail_bytes)) return std::nullopt;
  std::optional<std::int64_t> last;
  while (capture.next(datagram)) {
    if (datagram.destination_port == port) last = datagram.received_ns;
  }
  return last;
}

}  // namespace kissmap
