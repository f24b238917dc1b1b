// SPDX-License-Identifier: MIT
#include "formats/containers/container_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "kissmap/error.hpp"

namespace kissmap {

ContainerFile::ContainerFile(const std::filesystem::path& path) : path_(path) {
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0) {
    const int cause = errno;
    if (descriptor_ >= 0) ::close(descriptor_);
    throw input_error(path, "cannot be read: " + std::generic_category().message(cause));
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

ContainerFile::~ContainerFile() {
  ::close(descriptor_);
}

LogFile ContainerFile::log_file() const {
  return {path_.filename().string(), size_, ""};
}

std::span<const std::byte> ContainerFile::read(std::uint64_t offset,
                                               std::uint64_t count,
                                               std::vector<std::byte>& buffer) const {
  const std::uint64_t there = offset < size_ ? size_ - offset : 0;
  const auto wanted = static_cast<std::size_t>(std::min(count, there));
  if (buffer.size() < wanted) buffer.resize(wanted);
  std::size_t done = 0;
  while (done < wanted) {
    const ssize_t got = ::pread(
        descriptor_, buffer.data() + done, wanted - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      throw input_error(path_, "cannot be read: " + std::generic_category().message(errno));
    if (got == 0) break;  // it became shorter
    done += static_cast<std::size_t>(got);
  }
  return std::span<const std::byte>(buffer).first(done);
}

}  // namespace kissmap
