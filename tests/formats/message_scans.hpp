// SPDX-License-Identifier: MIT
// From bytes of a message to the scan that is made of it.
#pragma once

#include <optional>
#include <string>

#include "formats/containers/message_source.hpp"
#include "formats/logs/sweep_maker.hpp"
#include "formats/message_bytes.hpp"
#include "formats/support.hpp"

namespace kissmap::test {

inline constexpr std::int64_t received_ns = 1'600'000'000'000'000'001;

inline MessageEncoding encoding_of(RosForm form) {
  return form == RosForm::ros1 ? MessageEncoding::ros1 : MessageEncoding::cdr;
}

inline Topic topic_of(RosForm form, const std::string& type, const std::string& name = "/topic") {
  return {name, type, encoding_of(form), std::nullopt};
}

/// What one message becomes. Throws Refusal, as what is tested does.
inline Scan scan_of_message(const std::string& bytes,
                            const Topic& topic,
                            const ReadOptions& options = {}) {
  const auto maker = make_sweep_maker(topic, options);
  maker->add({0, received_ns, bytes_of(bytes)}, topic);
  std::optional<Scan> scan = maker->take();
  if (!scan) {
    maker->finish();
    scan = maker->take();
  }
  require_consistent(scan.value());
  return std::move(*scan);
}

inline Scan scan_of_cloud(RosForm form,
                          const CloudOfBytes& cloud,
                          const ReadOptions& options = {}) {
  return scan_of_message(
      point_cloud2(form, cloud), topic_of(form, "sensor_msgs/PointCloud2"), options);
}

}  // namespace kissmap::test
