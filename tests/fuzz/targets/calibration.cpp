// SPDX-License-Identifier: MIT
// The first byte chooses between a Hesai's angles, an HDL-64E's corrections, an Ouster's metadata,
// and packets of an HDL-64E.
#include <cmath>
#include <cstdlib>

#include "formats/clouds/refusal.hpp"
#include "formats/sensors/hdl_64e_decoder.hpp"
#include "formats/sensors/hesai_angle_file.hpp"
#include "formats/sensors/ouster_decoder.hpp"
#include "formats/text/lines.hpp"
#include "fuzz/target.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

void decode_packets(std::span<const std::byte> bytes) {
  constexpr std::size_t packet_size = 1206;
  const auto decoder = make_hdl_64e_decoder({});
  std::int64_t host_ns = 1'700'000'000'000'000'000;
  for (; bytes.size() >= packet_size; bytes = bytes.subspan(packet_size)) {
    decoder->add(bytes.first(packet_size), host_ns += 288'000);
  }
  decoder->finish();
  while (const auto scan = decoder->take()) require_consistent(*scan);
}

}  // namespace
}  // namespace kissmap

KISSMAP_FUZZ_TARGET(calibration) {
  if (input.empty()) return;
  const auto content = input.subspan(1);
  const std::string_view text = text_of(content);
  try {
    switch (std::to_integer<unsigned>(input[0]) % 4) {
      case 0:
        for (const HesaiAngle& angle : read_hesai_angles(text, "input")) {
          if (!std::isfinite(angle.elevation_deg + angle.azimuth_deg)) std::abort();
        }
        break;
      case 1:
        for (const Hdl64eLaser& laser : read_hdl_64e_calibration(text, "input")) {
          if (!std::isfinite(laser.rotation) || !std::isfinite(laser.distance)) std::abort();
        }
        break;
      case 2:
        make_ouster_decoder(read_ouster_metadata(text, "input"));
        break;
      default:
        decode_packets(content);
    }
  } catch (const Refusal&) {
    // A sensor or profile that is not supported.
  } catch (const Error& error) {
    if (error.fault() != Fault::input) std::abort();
  }
}
