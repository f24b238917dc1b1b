// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace kissmap {

/// Little-endian numbers one behind the other.
class ByteText {
 public:
  template <class T>
  ByteText& add(std::type_identity_t<T> value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    text_.append(bytes, sizeof(T));
    return *this;
  }
  ByteText& add_text(std::string_view text) {
    text_ += text;
    return *this;
  }
  /// With its length of 32 bits before it.
  ByteText& add_block(std::string_view text) {
    return add<std::uint32_t>(static_cast<std::uint32_t>(text.size())).add_text(text);
  }
  ByteText& pad_to(std::size_t size) {
    text_.resize(size, '\0');
    return *this;
  }
  std::size_t size() const { return text_.size(); }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace kissmap
