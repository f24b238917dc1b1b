// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace YAML {
class Node;
}

namespace kissmap {

/// Messages of each topic, as rosbag2 writes them down when a recording ends: in metadata.yaml
/// under "rosbag2_bagfile_information", in the database of newer bags by themselves. Throws
/// YAML::Exception.
std::map<std::string, std::uint64_t> recorded_counts(const YAML::Node& information);

}  // namespace kissmap
