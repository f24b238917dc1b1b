// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// Skips entries of a log that come of packets without decoding their points. `sweeps` are what the
/// log takes them from, with PacketDecoder::pass.
template <class Sweeps>
void pass_over(std::size_t count, Sweeps& sweeps, ScanLog& log) {
  for (; count > 0; --count) {
    // The last is decoded whole: a message refused behind the end of its last sweep is an entry
    // before its sweeps, so that one of them is left for next().
    sweeps.pass(count - 1);
    if (!log.next()) break;
  }
  sweeps.pass(0);
}

}  // namespace kissmap
