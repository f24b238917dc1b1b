// SPDX-License-Identifier: MIT
#include "formats/files/xxh3.hpp"

#include <xxhash.h>

#include <cstdio>
#include <new>

namespace kissmap {
namespace {

std::string hex_text(XXH128_hash_t hash) {
  char text[33];
  std::snprintf(text,
                sizeof text,
                "%016llx%016llx",
                static_cast<unsigned long long>(hash.high64),
                static_cast<unsigned long long>(hash.low64));
  return text;
}

}  // namespace

std::string xxh3_hex(std::string_view bytes) {
  return hex_text(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string xxh3_hex(std::span<const std::byte> bytes) {
  return xxh3_hex(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

std::uint64_t xxh3_64(std::string_view bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

Xxh3Stream::Xxh3Stream() : state_(XXH3_createState()) {
  if (!state_) throw std::bad_alloc();
  XXH3_128bits_reset(state_.get());
}

Xxh3Stream::~Xxh3Stream() = default;
Xxh3Stream::Xxh3Stream(Xxh3Stream&&) noexcept = default;
Xxh3Stream& Xxh3Stream::operator=(Xxh3Stream&&) noexcept = default;

void Xxh3Stream::add(std::string_view bytes) {
  XXH3_128bits_update(state_.get(), bytes.data(), bytes.size());
}

std::string Xxh3Stream::hex() const {
  return hex_text(XXH3_128bits_digest(state_.get()));
}

void Xxh3Stream::Free::operator()(XXH3_state_s* state) const {
  XXH3_freeState(state);
}

}  // namespace kissmap
