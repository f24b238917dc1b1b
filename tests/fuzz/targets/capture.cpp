// SPDX-License-Identifier: MIT
// Every datagram goes to every decoder of packets.
#include "formats/clouds/refusal.hpp"
#include "formats/containers/packet_capture.hpp"
#include "formats/sensors/hesai_decoder.hpp"
#include "formats/sensors/velodyne_decoder.hpp"
#include "fuzz/input_file.hpp"
#include "fuzz/target.hpp"
#include "kissmap/error.hpp"

KISSMAP_FUZZ_TARGET(capture) {
  const FuzzInputFile file(input);
  try {
    PacketCapture capture(file.path());
    const auto velodyne = make_velodyne_decoder();
    const auto hesai = make_hesai_decoder();
    Datagram datagram;
    while (capture.next(datagram)) {
      for (PacketDecoder* decoder : {velodyne.get(), hesai.get()}) {
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
