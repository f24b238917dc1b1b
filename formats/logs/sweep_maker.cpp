// SPDX-License-Identifier: MIT
#include "formats/logs/sweep_maker.hpp"

#include <utility>

#include "formats/clouds/refusal.hpp"
#include "formats/clouds/scan_decoder.hpp"
#include "formats/logs/packet_maker.hpp"
#include "formats/messages/cloud_message.hpp"
#include "formats/messages/packet_message.hpp"

namespace kissmap {
namespace {

class CloudMaker : public SweepMaker {
 public:
  explicit CloudMaker(const ReadOptions& options) : decoder_(options) {}

  void add(const Message& message, const Topic& topic) override {
    const CloudMessage cloud = read_cloud_message(message.data, topic);
    const bool stamped = cloud.stamp_ns != 0;
    unstamped_ = unstamped_ || !stamped;
    scan_ = decoder_.decode(cloud.records, stamped ? cloud.stamp_ns : message.received_ns);
    if (!cloud.frame_from_points) return;
    const Eigen::Isometry3f pose = cloud.frame_from_points->cast<float>();
    for (Eigen::Vector3f& point : scan_->points) point = pose * point;
  }

  std::optional<Scan> take() override { return std::exchange(scan_, std::nullopt); }
  bool one_scan_a_message() const override { return true; }
  std::string fields() const override { return decoder_.fields(); }

  std::vector<std::string> notes() const override {
    std::vector<std::string> notes{decoder_.time_note()};
    if (unstamped_) notes.emplace_back("messages without a stamp: the time of recording stands in");
    return notes;
  }

 private:
  ScanDecoder decoder_;
  std::optional<Scan> scan_;
  bool unstamped_ = false;
};

}  // namespace

bool holds_scans(const Topic& topic) {
  return is_cloud_type(topic) || packet_family(topic).has_value();
}

std::unique_ptr<SweepMaker> make_sweep_maker(const Topic& topic, const ReadOptions& options) {
  if (const auto family = packet_family(topic)) return make_packet_maker(*family, options);
  return std::make_unique<CloudMaker>(options);
}

}  // namespace kissmap
