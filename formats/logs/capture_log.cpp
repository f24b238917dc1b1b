// SPDX-License-Identifier: MIT
// Packet captures (pcap, pcapng) of one sensor on the network.
#include <utility>

#include "formats/clouds/cloud_file.hpp"
#include "formats/clouds/refusal.hpp"
#include "formats/containers/packet_capture.hpp"
#include "formats/files/input_file.hpp"
#include "formats/logs/capture_survey.hpp"
#include "formats/logs/logs.hpp"
#include "formats/logs/pass_over.hpp"
#include "formats/sensors/ouster_packet.hpp"
#include "formats/sensors/sensor_calibration.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

/// Which datagrams are the sensor's, and what decodes them.
struct Choice {
  std::uint16_t port = 0;
  std::unique_ptr<PacketDecoder> decoder;
  std::vector<LogFile> side_files;
};

std::uint16_t chosen_port(const std::vector<std::uint16_t>& ports,
                          const std::string& wanted,
                          const fs::path& path) {
  std::string list;
  for (const std::uint16_t port : ports) {
    if (wanted == std::to_string(port)) return port;
    list += "\n  " + std::to_string(port);
  }
  if (!wanted.empty()) {
    throw usage_error("--topic " + wanted + ": no sensor sends to this port in " + path.string() +
                      "; ports:" + list);
  }
  if (ports.size() > 1) {
    throw input_error(path, "sensors send to several ports; choose one with --topic:" + list);
  }
  return ports.front();
}

std::vector<std::uint16_t> ports_with(const CaptureSurvey& survey, std::size_t size) {
  std::vector<std::uint16_t> ports;
  for (const auto& [stream, count] : survey.streams) {
    if (stream.size == size) ports.push_back(stream.port);
  }
  return ports;
}

std::uint16_t ouster_port(const fs::path& path,
                          const CaptureSurvey& survey,
                          const SensorCalibration& metadata,
                          const std::string& wanted) {
  const auto* about = std::get_if<OusterMetadata>(&metadata.content);
  if (about == nullptr) throw input_error(path, "the calibration is not an Ouster's metadata");
  const std::size_t size = OusterPackets(*about).packet_bytes();
  const auto ports = ports_with(survey, size);
  if (!ports.empty()) return chosen_port(ports, wanted, path);
  throw input_error(path,
                    "holds no packets of " + std::to_string(size) + " bytes, as " +
                        metadata.file.name + " describes them");
}

// Packets of an Ouster look like nothing else: what is not of another sensor is tried.
Choice choose_ouster(const fs::path& path,
                     const CaptureSurvey& survey,
                     const ReadOptions& options) {
  const fs::path file =
      options.calibration.empty() ? find_ouster_metadata(path) : fs::path(options.calibration);
  const SensorCalibration metadata = read_sensor_calibration(file);
  const std::uint16_t port = ouster_port(path, survey, metadata, options.topic);
  return {port, make_packet_decoder(SensorFamily::ouster, metadata), {metadata.file}};
}

Choice choose_marked(const fs::path& path,
                     const CaptureSurvey& survey,
                     const ReadOptions& options) {
  std::vector<std::uint16_t> ports;
  for (const auto& [port, family] : survey.marked) ports.push_back(port);
  const std::uint16_t port = chosen_port(ports, options.topic, path);
  const SensorCalibration calibration = read_sensor_calibration(options.calibration);
  Choice choice{port, make_packet_decoder(survey.marked.at(port), calibration), {}};
  if (!options.calibration.empty()) choice.side_files.push_back(calibration.file);
  return choice;
}

// Sensors that are not read, unless there is another to choose.
void require_readable(const fs::path& path,
                      const CaptureSurvey& survey,
                      const ReadOptions& options) {
  for (const auto& [port, description] : survey.foreign) {
    const bool wanted = options.topic == std::to_string(port);
    const bool no_other = survey.marked.empty() && options.calibration.empty();
    if (wanted || no_other) {
      throw input_error(path, description + " (to port " + std::to_string(port) + ")");
    }
  }
}

Choice choose(const fs::path& path, const CaptureSurvey& survey, const ReadOptions& options) {
  if (survey.streams.empty()) throw input_error(path, "holds no UDP datagrams");
  require_readable(path, survey, options);
  if (!survey.marked.empty()) return choose_marked(path, survey, options);
  try {
    return choose_ouster(path, survey, options);
  } catch (const Error& error) {
    throw Error(error.fault(),
                std::string(error.what()) +
                    "\nNo packets of another sensor known here in it; datagrams:" + listed(survey));
  }
}

class CaptureLog : public ScanLog {
 public:
  CaptureLog(const fs::path& path, const CaptureSurvey& survey, Choice choice)
      : capture_(path), choice_(std::move(choice)) {
    info_.format = "pcap";
    info_.path = path;
    info_.stamp_source = "packets";
    info_.fields = "x f32, y f32, z f32, intensity f32, time f32";
    info_.notes.push_back("packets to port " + std::to_string(choice_.port) +
                          ", sweeps with a time for each point");
    info_.topics = topics_of(survey);
    if (!survey.marked.contains(choice_.port)) {
      info_.topics.push_back({std::to_string(choice_.port), "Ouster packets", std::nullopt});
    }
    set_time_range(survey.first_ns.at(choice_.port));
    peeked_ = read();
    info_.sensor = choice_.decoder->sensor();
  }

  const LogInfo& info() const override { return info_; }

  std::optional<LogEntry> next() override {
    std::optional<LogEntry> entry = peeked_ ? std::exchange(peeked_, std::nullopt) : read();
    if (entry) entry->index = next_index_++;
    return entry;
  }

  void skip(std::size_t count) override { pass_over(count, *choice_.decoder, *this); }

  std::vector<LogFile> files() const override {
    std::vector<LogFile> files = choice_.side_files;
    files.push_back(capture_.log_file());
    return files;
  }

 private:
  void set_time_range(std::int64_t first_ns) {
    const auto last_ns = last_received(info_.path, choice_.port);
    if (last_ns && *last_ns > first_ns) info_.time_range.emplace(first_ns, *last_ns);
  }

  std::string name() const { return "sweep " + std::to_string(sweeps_); }

  std::optional<LogEntry> read() {
    while (true) {
      if (auto scan = choice_.decoder->take()) {
        LogEntry entry{0, name(), std::move(*scan)};
        ++sweeps_;
        return entry;
      }
      if (at_end_) return read_damage();
      Datagram datagram;
      try {
        if (!capture_.next(datagram)) {
          at_end_ = true;
          choice_.decoder->finish();
        } else if (datagram.destination_port == choice_.port) {
          choice_.decoder->add(datagram.payload, datagram.received_ns);
        }
      } catch (const Refusal& refusal) {
        throw input_error(info_.path, refusal.what());
      }
    }
  }

  std::optional<LogEntry> read_damage() {
    if (damage_read_ || !capture_.damage()) return std::nullopt;
    damage_read_ = true;
    return LogEntry{0,
                    info_.path.filename().string(),
                    RefusedScan{capture_.damage()->reason, capture_.damage()->detail}};
  }

  PacketCapture capture_;
  Choice choice_;
  LogInfo info_;
  std::optional<LogEntry> peeked_;
  std::size_t next_index_ = 0;
  std::size_t sweeps_ = 0;
  bool at_end_ = false;
  bool damage_read_ = false;
};

}  // namespace

bool probe_capture(const fs::path& path) {
  const auto kind = kind_by_content(first_bytes(path, probe_size));
  return kind == "pcap capture" || kind == "pcapng capture";
}

std::unique_ptr<ScanLog> open_capture(const fs::path& path, const ReadOptions& options) {
  require_valid(options);
  try {
    const CaptureSurvey survey = survey_capture(path);
    return std::make_unique<CaptureLog>(path, survey, choose(path, survey, options));
  } catch (const Refusal& refusal) {
    throw input_error(path, refusal.what());
  }
}

}  // namespace kissmap
