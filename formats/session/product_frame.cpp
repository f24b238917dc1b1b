// SPDX-License-Identifier: MIT
#include "kissmap/formats/product_frame.hpp"

#include <utility>

namespace kissmap {

const char* name_of(ProductFrame frame) {
  return frame == ProductFrame::level ? "level" : "map";
}

Rigid3 frame_from_map(const Session& session, ProductFrame frame) {
  return frame == ProductFrame::level ? level_from_map(session) : Rigid3{};
}

Session moved(Session session, const Rigid3& frame_from_map) {
  for (SessionScan& scan : session.scans) {
    scan.mapped.map_from_lidar = frame_from_map * scan.mapped.map_from_lidar;
  }
  for (LocalMap& local_map : session.local_maps) {
    local_map.map_from_local_map = frame_from_map * local_map.map_from_local_map;
  }
  return session;
}

Session levelled(Session session) {
  const Rigid3 level = level_from_map(session);
  return moved(std::move(session), level);
}

}  // namespace kissmap
