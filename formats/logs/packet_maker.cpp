// SPDX-License-Identifier: MIT
#include "formats/logs/packet_maker.hpp"

#include <utility>

#include "formats/clouds/refusal.hpp"
#include "formats/messages/packet_message.hpp"
#include "formats/sensors/hesai_decoder.hpp"
#include "formats/sensors/velodyne_decoder.hpp"

namespace kissmap {
namespace {

class PacketMaker : public SweepMaker {
 public:
  PacketMaker(Topic topic, std::unique_ptr<PacketDecoder> decoder)
      : topic_(std::move(topic)), decoder_(std::move(decoder)) {}

  void add(const Message& message) override {
    for_each_packet(message, topic_, [this](std::span<const std::byte> packet, std::int64_t ns) {
      decoder_->add(packet, ns);
    });
  }
  std::optional<Scan> take() override { return decoder_->take(); }
  void finish() override { decoder_->finish(); }
  bool one_scan_a_message() const override { return false; }
  std::string sensor() const override { return decoder_->sensor(); }
  std::string fields() const override { return "x f32, y f32, z f32, intensity f32, time f32"; }

  std::vector<std::string> notes() const override {
    return {"sweeps from the packets of the sensor, with a time for each point"};
  }

 private:
  Topic topic_;
  std::unique_ptr<PacketDecoder> decoder_;
};

}  // namespace

std::unique_ptr<SweepMaker> make_packet_maker(const Topic& topic) {
  switch (packet_family(topic)) {
    case PacketFamily::velodyne:
      return std::make_unique<PacketMaker>(topic, make_velodyne_decoder());
    case PacketFamily::hesai:
      return std::make_unique<PacketMaker>(topic, make_hesai_decoder());
    case PacketFamily::ouster:
    case PacketFamily::none:
      break;
  }
  throw Refusal(refusal_reason::unsupported, "packets of type " + topic.type);
}

}  // namespace kissmap
