// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace kissmap {

/// "sensor_msgs/msg/PointCloud2", as ROS 2 names a type, without the "msg" in its middle.
inline std::string ros_type_name(std::string_view name) {
  constexpr std::string_view middle = "/msg/";
  const std::size_t found = name.find(middle);
  if (found == std::string_view::npos) return std::string(name);
  return std::string(name.substr(0, found + 1)) + std::string(name.substr(found + middle.size()));
}

}  // namespace kissmap
