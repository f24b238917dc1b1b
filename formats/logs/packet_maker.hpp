// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "formats/logs/sweep_maker.hpp"

namespace kissmap {

/// Scans from messages that hold a sensor's data packets.
std::unique_ptr<SweepMaker> make_packet_maker(const Topic& topic);

}  // namespace kissmap
