// SPDX-License-Identifier: MIT
// Every datagram goes to every decoder of packets, and to one that passes over the first sweeps and
// has to give the same ones after them.
#include <array>
#include <cstdlib>
#include <memory>
#include <utility>

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

class Pair {
 public:
  Pair(std::unique_ptr<PacketDecoder> whole,
       std::unique_ptr<PacketDecoder> passing,
       std::size_t passed)
      : whole_(std::move(whole)), passing_(std::move(passing)), passed_(passed) {
    passing_->pass(passed);
  }

  void add(const Datagram& datagram) {
    for (PacketDecoder* decoder : {whole_.get(), passing_.get()}) {
      try {
        decoder->add(datagram.payload, datagram.received_ns);
      } catch (const Refusal&) {
        // A sensor that is not supported.
      }
    }
    while (const auto scan = whole_->take()) {
      require_consistent(*scan);
      const auto other = passing_->take();
      if (!other) std::abort();
      if (sweeps_++ >= passed_ && other->points != scan->points) std::abort();
    }
    if (passing_->take()) std::abort();
  }

 private:
  std::unique_ptr<PacketDecoder> whole_;
  std::unique_ptr<PacketDecoder> passing_;
  std::size_t passed_;
  std::size_t sweeps_ = 0;
};

}  // namespace
}  // namespace kissmap

KISSMAP_FUZZ_TARGET(capture) {
  const FuzzInputFile file(input);
  try {
    PacketCapture capture(file.path());
    const std::size_t passed = input.size() % 4;
    std::array<Pair, 3> decoders{
        Pair{make_velodyne_decoder(), make_velodyne_decoder(), passed},
        Pair{make_hesai_decoder(), make_hesai_decoder(), passed},
        Pair{make_ouster_decoder(small_ouster()), make_ouster_decoder(small_ouster()), passed}};
    Datagram datagram;
    while (capture.next(datagram)) {
      for (Pair& decoder : decoders) decoder.add(datagram);
    }
  } catch (const Error& error) {
    if (error.fault() != Fault::input) std::abort();
  }
}
