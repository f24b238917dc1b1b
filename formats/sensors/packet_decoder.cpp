// SPDX-License-Identifier: MIT
#include "formats/sensors/packet_decoder.hpp"

#include <algorithm>
#include <utility>

namespace kissmap {

std::optional<Scan> PacketDecoder::take() {
  if (sweeps_.empty()) return std::nullopt;
  std::optional<Scan> oldest(std::move(sweeps_.front()));
  sweeps_.pop_front();
  return oldest;
}

void PacketDecoder::pass(std::size_t sweeps) {
  pass_incomplete(sweeps - std::min(sweeps, sweeps_.size()));
}

}  // namespace kissmap
