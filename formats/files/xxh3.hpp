// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct XXH3_state_s;

namespace kissmap {

/// XXH3-128 of some bytes, 32 hex digits, as LogFile::xxh3 holds it and `xxh128sum` prints it.
std::string xxh3_hex(std::string_view bytes);
std::string xxh3_hex(std::span<const std::byte> bytes);

/// XXH3-64 with seed 0.
std::uint64_t xxh3_64(std::string_view bytes);

/// XXH3-128 of bytes that come piece by piece.
class Xxh3Stream {
 public:
  Xxh3Stream();
  ~Xxh3Stream();
  Xxh3Stream(Xxh3Stream&&) noexcept;
  Xxh3Stream& operator=(Xxh3Stream&&) noexcept;

  void add(std::string_view bytes);
  std::string hex() const;

 private:
  struct Free {
    void operator()(XXH3_state_s* state) const;
  };
  std::unique_ptr<XXH3_state_s, Free> state_;
};

}  // namespace kissmap
