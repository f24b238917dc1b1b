// SPDX-License-Identifier: MIT
#include "formats/logs/packet_maker.hpp"

#include <utility>

#include "formats/clouds/refusal.hpp"
#include "formats/messages/message_reader.hpp"
#include "formats/messages/packet_message.hpp"
#include "formats/sensors/ouster_decoder.hpp"
#include "formats/sensors/sensor_calibration.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

class PacketMaker : public SweepMaker {
 public:
  PacketMaker(std::unique_ptr<PacketDecoder> decoder, LogFile calibration)
      : decoder_(std::move(decoder)), calibration_(std::move(calibration)) {}

  void add(const Message& message, const Topic& topic) override {
    for_each_packet(message, topic, [this](std::span<const std::byte> packet, std::int64_t ns) {
      decoder_->add(packet, ns);
    });
  }
  std::optional<Scan> take() override { return decoder_ ? decoder_->take() : std::nullopt; }
  void pass(std::size_t scans) override {
    to_pass_ = scans;
    if (decoder_) decoder_->pass(to_pass_);
  }
  void finish() override {
    if (decoder_) decoder_->finish();
  }
  bool one_scan_a_message() const override { return false; }
  std::string sensor() const override { return decoder_ ? decoder_->sensor() : ""; }
  std::string fields() const override { return "x f32, y f32, z f32, intensity f32, time f32"; }

  std::vector<std::string> notes() const override {
    return {"sweeps from the packets of the sensor, with a time for each point"};
  }

  std::vector<LogFile> side_files() const override {
    if (calibration_.name.empty()) return {};
    return {calibration_};
  }

 protected:
  std::unique_ptr<PacketDecoder> decoder_;
  std::size_t to_pass_ = 0;

 private:
  LogFile calibration_;
};

constexpr std::size_t most_waiting_bytes = 64 << 20;

/// Packets of an Ouster sensor wait until the metadata comes, which is recorded beside them.
class OusterMaker : public PacketMaker {
 public:
  OusterMaker() : PacketMaker(nullptr, {}) {}

  bool wants(const Topic& topic) const override {
    return topic.type == "std_msgs/String" && topic.name.find("metadata") != std::string::npos;
  }

  void add(const Message& message, const Topic& topic) override {
    if (wants(topic)) {
      if (!decoder_) begin(std::string(MessageReader(message.data, topic.encoding).text()));
      return;
    }
    if (decoder_) return PacketMaker::add(message, topic);
    waiting_bytes_ += message.data.size();
    if (waiting_bytes_ > most_waiting_bytes) throw_missing();
    waiting_.push_back({{message.topic, message.received_ns, {}},
                        topic,
                        {message.data.begin(), message.data.end()}});
  }

  void finish() override {
    if (!decoder_) throw_missing();
    PacketMaker::finish();
  }

 private:
  struct Waiting {
    Message message;
    Topic topic;
    std::vector<std::byte> data;
  };

  [[noreturn]] static void throw_missing() {
    throw Refusal(refusal_reason::broken_content,
                  "packets of an Ouster sensor without its metadata, a std_msgs/String on a topic "
                  "named metadata");
  }

  void begin(const std::string& json) {
    decoder_ = make_ouster_decoder(read_ouster_metadata(json, "metadata topic"));
    decoder_->pass(to_pass_);
    for (Waiting& packet : waiting_) {
      packet.message.data = packet.data;
      PacketMaker::add(packet.message, packet.topic);
    }
    waiting_.clear();
  }

  std::vector<Waiting> waiting_;
  std::size_t waiting_bytes_ = 0;
};

}  // namespace

std::unique_ptr<SweepMaker> make_packet_maker(SensorFamily family, const ReadOptions& options) {
  const SensorCalibration calibration = read_sensor_calibration(options.calibration);
  if (family == SensorFamily::ouster && options.calibration.empty()) {
    return std::make_unique<OusterMaker>();
  }
  try {
    return std::make_unique<PacketMaker>(make_packet_decoder(family, calibration),
                                         calibration.file);
  } catch (const Refusal& refusal) {
    throw input_error(options.calibration, refusal.what());
  }
}

}  // namespace kissmap
