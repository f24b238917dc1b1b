// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "formats/containers/container_file.hpp"

namespace kissmap {

/// The times of the first packets of the first frame of an LVX file, which begins at
/// `first_frame`, and of the last one [ns of the sensor's clock]. None where the last frame is not
/// found in the last 4 MiB, or is of another sensor, whose clock may differ.
std::optional<std::pair<std::int64_t, std::int64_t>> lvx_time_range(const ContainerFile& file,
                                                                    std::uint64_t first_frame,
                                                                    std::size_t frame_head_bytes);

}  // namespace kissmap
