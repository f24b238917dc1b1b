// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "formats/logs/sweep_maker.hpp"
#include "formats/sensors/packet_decoder.hpp"

namespace kissmap {

/// Scans from messages that hold a sensor's data packets. Throws Error for a calibration that
/// cannot be read.
std::unique_ptr<SweepMaker> make_packet_maker(SensorFamily family, const ReadOptions& options);

}  // namespace kissmap
