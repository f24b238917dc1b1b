// SPDX-License-Identifier: MIT
#pragma once

#include "kissmap/formats/session.hpp"

namespace kissmap {

/// The frame of what is made from a session.
enum class ProductFrame : std::uint8_t {
  level,  ///< see level_from_map(): z = 0 on the ground where the first local map lies
  map,    ///< the session's own, that of trajectory.tum
};
const char* name_of(ProductFrame frame);

/// Identity for ProductFrame::map. Throws Error(input) as level_from_map() does.
Rigid3 frame_from_map(const Session& session, ProductFrame frame);

/// The session as it would be had its map frame been another: all scans and local maps are moved,
/// what is measured between them stays.
Session moved(Session session, const Rigid3& frame_from_map);

/// The session in ProductFrame::level.
Session levelled(Session session);

}  // namespace kissmap
