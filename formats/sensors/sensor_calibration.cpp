// SPDX-License-Identifier: MIT
#include "formats/sensors/sensor_calibration.hpp"

#include <string>
#include <vector>

#include "formats/clouds/refusal.hpp"
#include "formats/files/input_file.hpp"
#include "formats/sensors/hdl_64e_decoder.hpp"
#include "formats/sensors/hesai_angle_file.hpp"
#include "formats/sensors/ouster_decoder.hpp"
#include "formats/sensors/velodyne_decoder.hpp"
#include "formats/text/lines.hpp"
#include "formats/text/lower_case.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

[[noreturn]] void throw_mismatch(const char* sensor, const char* wanted) {
  throw Refusal(refusal_reason::wrong_kind,
                std::string("packets of ") + sensor + ", but the calibration is not " + wanted);
}

}  // namespace

SensorCalibration read_sensor_calibration(const std::filesystem::path& path) {
  SensorCalibration calibration;
  if (path.empty()) return calibration;
  const std::string ending = lower_case(path.extension().string());
  if (ending != ".csv" && ending != ".yaml" && ending != ".yml" && ending != ".json") {
    throw usage_error(
        "--calibration " + path.string() +
        ": wants a Hesai's angles (.csv), the ROS driver's file of an HDL-64E (.yaml) "
        "or an Ouster's metadata (.json)");
  }
  const std::vector<std::byte> bytes = read_side_file(path);
  calibration.file = {path.filename().string(), bytes.size(), ""};
  const std::string_view text = text_of(bytes);
  if (ending == ".csv") {
    calibration.content = read_hesai_angles(text, path);
  } else if (ending == ".json") {
    calibration.content = read_ouster_metadata(text, path);
  } else {
    calibration.content = read_hdl_64e_calibration(text, path);
  }
  return calibration;
}

std::unique_ptr<PacketDecoder> make_packet_decoder(SensorFamily family,
                                                   const SensorCalibration& calibration) {
  const bool none = std::holds_alternative<std::monostate>(calibration.content);
  switch (family) {
    case SensorFamily::velodyne:
      if (none) return make_velodyne_decoder();
      if (const auto* unit = std::get_if<Hdl64eCalibration>(&calibration.content)) {
        return make_hdl_64e_decoder(*unit);
      }
      throw_mismatch("a Velodyne", "an HDL-64E's");
    case SensorFamily::hesai:
      if (none) return make_hesai_decoder();
      if (const auto* unit = std::get_if<HesaiAngles>(&calibration.content)) {
        return make_hesai_decoder(*unit);
      }
      throw_mismatch("a Hesai", "a file of its angles");
    case SensorFamily::ouster:
      break;
  }
  if (const auto* about = std::get_if<OusterMetadata>(&calibration.content)) {
    return make_ouster_decoder(*about);
  }
  throw_mismatch("an Ouster", "its metadata");
}

}  // namespace kissmap
