// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "formats/session/pack_bytes.hpp"

namespace kissmap {

// Arrays of a scan as columns of a pack. Decoders throw DamagedPack.

/// Points [m] in steps of pack_resolution; stays a valid return: never (0, 0, 0) and never beyond
/// max_plausible_range.
void encode_points(ByteWriter& bytes, const std::vector<Eigen::Vector3f>& points);
std::vector<Eigen::Vector3f> decode_points(ByteReader& bytes, std::size_t size);

/// Unit vectors to 1e-4 rad.
void encode_directions(ByteWriter& bytes, const std::vector<Eigen::Vector3f>& directions);
std::vector<Eigen::Vector3f> decode_directions(ByteReader& bytes, std::size_t size);

/// Time offsets [s] to 1 ns; unchanged if one of them is too large for that.
void encode_times(ByteWriter& bytes, const std::vector<float>& times);
std::vector<float> decode_times(ByteReader& bytes, std::size_t size);

/// Any floats, bit by bit.
void encode_intensities(ByteWriter& bytes, const std::vector<float>& intensities);
std::vector<float> decode_intensities(ByteReader& bytes, std::size_t size);

}  // namespace kissmap
