// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <cstdlib>
#include <set>

#include "formats/clouds/refusal.hpp"
#include "formats/containers/message_source.hpp"
#include "fuzz/input_file.hpp"
#include "kissmap/error.hpp"

namespace kissmap {

/// Messages read so far: of stored inputs there have to be some.
inline std::uint64_t fuzz_messages = 0;

/// Reads every message of the container that `open` opens, which has to come to an end.
template <class Open>
void read_messages(Open open) {
  try {
    const auto source = open();
    std::set<std::size_t> all;
    for (std::size_t i = 0; i < source->topics().size(); ++i) all.insert(i);
    source->select(all);
    Message message;
    unsigned sum = 0;
    while (source->next(message)) {
      if (message.topic >= source->topics().size()) std::abort();
      ++fuzz_messages;
      // Every byte has to be there.
      for (const std::byte byte : message.data) sum += std::to_integer<unsigned>(byte);
    }
    [[maybe_unused]] volatile unsigned used = sum;
  } catch (const Error& error) {
    if (error.fault() != Fault::input) std::abort();
  }
}

/// The same of a container that is the input.
template <class Open>
void read_container(std::span<const std::byte> input, Open open) {
  const FuzzInputFile file(input);
  read_messages([&] { return open(file.path()); });
}

}  // namespace kissmap
