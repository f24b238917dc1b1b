// SPDX-License-Identifier: MIT
#include "formats/containers/bag_metadata.hpp"

#include <yaml-cpp/yaml.h>

namespace kissmap {

std::map<std::string, std::uint64_t> recorded_counts(const YAML::Node& information) {
  std::map<std::string, std::uint64_t> counts;
  for (const YAML::Node& topic : information["topics_with_message_count"]) {
    counts[topic["topic_metadata"]["name"].as<std::string>()] +=
        topic["message_count"].as<std::uint64_t>();
  }
  return counts;
}

}  // namespace kissmap
