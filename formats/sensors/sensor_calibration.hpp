// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <variant>

#include "formats/sensors/hdl_64e_calibration.hpp"
#include "formats/sensors/hesai_decoder.hpp"
#include "formats/sensors/ouster_metadata.hpp"
#include "formats/sensors/packet_decoder.hpp"
#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// What came with one unit of a sensor: angles of a Hesai, corrections of an HDL-64E, metadata of
/// an Ouster; or nothing.
struct SensorCalibration {
  std::variant<std::monostate, HesaiAngles, Hdl64eCalibration, OusterMetadata> content;
  LogFile file;
};

/// The file told by its ending: .csv, .yaml or .yml, .json. An empty path is nothing. Throws
/// Error(usage) for another ending, Error(input) for what the file does not hold.
SensorCalibration read_sensor_calibration(const std::filesystem::path& path);

/// The decoder of a family's packets. Throws Refusal where the calibration belongs to another
/// family, or where an Ouster has none.
std::unique_ptr<PacketDecoder> make_packet_decoder(SensorFamily family,
                                                   const SensorCalibration& calibration);

}  // namespace kissmap
