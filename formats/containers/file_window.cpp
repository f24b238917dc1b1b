// SPDX-License-Identifier: MIT
#include "formats/containers/file_window.hpp"

#include <algorithm>

namespace kissmap {
namespace {

constexpr std::uint64_t window_bytes = 1 << 20;

}  // namespace

std::span<const std::byte> FileWindow::at(std::uint64_t offset, std::uint64_t count) {
  const bool inside = offset >= offset_ && offset - offset_ <= size_;
  if (!inside || count > size_ - (offset - offset_)) {
    size_ = file_.read(offset, std::max(count, window_bytes), bytes_).size();
    offset_ = offset;
  }
  const auto from = static_cast<std::size_t>(offset - offset_);
  return std::span<const std::byte>(bytes_).subspan(from,
                                                    std::min<std::uint64_t>(count, size_ - from));
}

}  // namespace kissmap
