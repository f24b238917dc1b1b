// SPDX-License-Identifier: MIT
// Every datagram goes to every decoder of packets.
#include "formats/clouds/refusal.hpp"
#include "formats/containers/packet_capture.hpp"
#include "formats/sensors/hesai_decoder.hpp"
#include "formats/sensors/ouster_decoder.hpp"
#include "formats/sensors/velodyne_decoder.hpp"
#include "fuzz/input_file.hpp"
#include "fuzz/target.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

/// A sensor of two beams, whose packets are 704 bytes long.
OusterMetadata small_ouster() {
  OusterMetadata about;
  about.product = "OS-1-2";
  about.beams = 2;
  about.columns_per_frame = 512;
  about.altitudes_deg = {10.0, -10.0};
  about.azimuths_deg = {1.0, -1.0};
  return about;
}

}  // namespace
}  // namespace kissmap

KISSMAP_FUZZ_TARGET(capture) {
  const FuzzInputFile file(input);
  try {
    PacketCapture capture(file.path());
    const auto velodyne = make_velodyne_decoder();
    const auto hesai = make_hesai_decoder();
    const auto ouster = make_ouster_decoder(small_ouster());
    Datagram datagram;
    while (capture.next(datagram)) {
      for (PacketDecoder* decoder : {velodyne.get(), hesai.get(), ouster.get()}) {
        try {
          decoder->add(datagram.payload, datagram.received_ns);
        } catch (const Refusal&) {
          // A sensor that is not supported.
        }
        while (const auto scan = decoder->take()) require_consistent(*scan);
      }
    }
  } catch (const Error& error) {
    if (error.fault() != Fault::input) std::abort();
  }
}
