// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "formats/sensors/ouster_metadata.hpp"
#include "formats/sensors/packet_decoder.hpp"

namespace kissmap {

/// Decoder of Ouster's data packets, of the profiles ouster_profile() knows. Points are in the
/// sensor's frame, x forward, away from the cable's side as its manual draws it, in the order in
/// which they were fired; of two returns of a shot both, if they differ. The intensity is the
/// signal, or the reflectivity where the profile has none. Each point has the time of its column;
/// where the sensor's clock is more than a day from the receiver's, sweeps are stamped by the
/// receiver's. A sweep is a frame of the sensor; a packet may come one frame late.
/// Throws Refusal for a profile that is not known.
std::unique_ptr<PacketDecoder> make_ouster_decoder(const OusterMetadata& about);

}  // namespace kissmap
