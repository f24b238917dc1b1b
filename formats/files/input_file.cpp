// SPDX-License-Identifier: MIT
#include "formats/files/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <span>
#include <system_error>

#include "formats/clouds/refusal.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

class OpenFile {
 public:
  explicit OpenFile(const std::filesystem::path& path)
      :  // Without O_NONBLOCK a named pipe would keep us waiting for a writer.
        descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    if (descriptor_ < 0) fail("cannot be opened");
  }
  ~OpenFile() { ::close(descriptor_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  std::uint64_t size() const {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) fail("has no size");
    if (!S_ISREG(status.st_mode)) throw Refusal(refusal_reason::unreadable, "is not a file");
    return static_cast<std::uint64_t>(status.st_size);
  }

  /// Bytes read: fewer than asked for only at the end of the file.
  std::size_t read(std::span<std::byte> out) const {
    std::size_t done = 0;
    while (done < out.size()) {
      const ssize_t count = ::read(descriptor_, out.data() + done, out.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail("cannot be read");
      if (count == 0) break;
      done += static_cast<std::size_t>(count);
    }
    return done;
  }

 private:
  [[noreturn]] static void fail(const char* what) {
    throw Refusal(refusal_reason::unreadable,
                  std::string(what) + ": " + std::generic_category().message(errno));
  }
  int descriptor_;
};

}  // namespace

void read_file(const std::filesystem::path& path, std::vector<std::byte>& buffer) {
  const OpenFile file(path);
  const std::uint64_t size = file.size();
  if (size > max_file_bytes) {
    throw Refusal(refusal_reason::too_large,
                  std::to_string(size) + " bytes; a scan has at most 2 GiB. Is it a whole map?");
  }
  buffer.resize(static_cast<std::size_t>(size));
  buffer.resize(file.read(buffer));
}

std::vector<std::byte> read_side_file(const std::filesystem::path& path) {
  std::vector<std::byte> bytes;
  try {
    read_file(path, bytes);
  } catch (const Refusal& refusal) {
    throw input_error(path, refusal.what());
  }
  return bytes;
}

std::vector<std::byte> first_bytes(const std::filesystem::path& path, std::size_t count) noexcept {
  try {
    if (!std::filesystem::is_regular_file(path)) return {};
    std::vector<std::byte> bytes(count);
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(count));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
    return bytes;
  } catch (...) {
    return {};
  }
}

}  // namespace kissmap
