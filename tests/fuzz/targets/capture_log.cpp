// SPDX-License-Identifier: MIT
// A capture as a log: the first byte chooses the port asked for, the calibration, and whether an
// Ouster's metadata lies beside it.
#include <array>
#include <cstdlib>

#include "formats/logs/logs.hpp"
#include "formats/text/lines.hpp"
#include "fuzz/folder.hpp"
#include "fuzz/ouster_json.hpp"
#include "fuzz/target.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

const FuzzFolder& folder() {
  static const FuzzFolder made;
  static const bool written = [] {
    made.write("beside/capture.json", small_ouster_json);
    made.write("alone/readme", "");
    made.write("angles.csv", "Channel,Elevation,Azimuth\n1,1.0,0.5\n2,-1.0,0.5\n");
    return true;
  }();
  if (!written) std::abort();
  return made;
}

}  // namespace
}  // namespace kissmap

KISSMAP_FUZZ_TARGET(capture_log) {
  if (input.empty()) return;
  constexpr std::array topics{"", "", "2368", "7502"};
  constexpr std::array calibrations{"", "", "beside/capture.json", "angles.csv"};
  const auto first = std::to_integer<unsigned>(input[0]);
  const std::string place = (first & 16U) != 0 ? "beside/" : "alone/";
  folder().write(place + "capture.pcap", text_of(input.subspan(1)));
  ReadOptions options;
  options.topic = topics[first % 4];
  const std::string calibration = calibrations[first / 4 % 4];
  if (!calibration.empty()) options.calibration = folder().path() / calibration;
  try {
    const auto log = open_capture(folder().path() / (place + "capture.pcap"), options);
    while (const auto entry = log->next()) {
      if (const auto* scan = std::get_if<Scan>(&entry->content)) require_consistent(*scan);
    }
  } catch (const Error& error) {
    const bool wrong_port = error.fault() == Fault::usage && !options.topic.empty();
    if (error.fault() != Fault::input && !wrong_port) std::abort();
  }
}
