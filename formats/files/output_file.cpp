// SPDX-License-Identifier: MIT
#include "formats/files/output_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

constexpr std::size_t buffer_size = 1 << 16;

const char* cure(int code) {
  switch (code) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "free some space there or write elsewhere";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder you may write to";
    case ENOENT:
    case ENOTDIR:
      return "create the folder first";
    default:
      return "choose another place";
  }
}

Error system_error(const std::filesystem::path& path, const char* action, int code) {
  return output_error(path,
                      std::string("cannot ") + action + ": " +
                          std::generic_category().message(code) + "; " + cure(code));
}

// Pipes and devices have nothing to flush to a disk and say so with EINVAL.
bool sync_descriptor(int descriptor) {
  return ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
}

void write_all(int descriptor, std::string_view bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw system_error(path, "write", errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

/// Files written aside; those still there are removed when it goes.
class AsideFiles {
 public:
  AsideFiles() = default;
  ~AsideFiles() {
    std::error_code ignored;  // whoever left early has said why
    for (const std::filesystem::path& path : made_) std::filesystem::remove(path, ignored);
  }
  AsideFiles(const AsideFiles&) = delete;
  AsideFiles& operator=(const AsideFiles&) = delete;

  void write(const std::filesystem::path& path, std::string_view bytes) {
    OutputFile file(aside(path));
    made_.push_back(file.path());
    file.write(bytes);
    file.close();
  }

 private:
  std::vector<std::filesystem::path> made_;
};

}  // namespace

OutputFile::OutputFile(std::filesystem::path path) : path_(std::move(path)) {
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw system_error(path_, "create", errno);
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void OutputFile::write(std::string_view bytes) {
  if (descriptor_ < 0) throw Error(Fault::internal, path_.string() + ": written after its end");
  bytes_ += bytes.size();
  if (bytes.size() >= buffer_size) {
    flush();
    return write_all(descriptor_, bytes, path_);
  }
  buffer_ += bytes;
  if (buffer_.size() >= buffer_size) flush();
}

void OutputFile::flush() {
  // Emptied first: what failed once is not tried again by the next call.
  const std::string bytes = std::exchange(buffer_, {});
  write_all(descriptor_, bytes, path_);
}

void OutputFile::rewrite_beginning(std::string_view bytes) {
  if (bytes.size() > bytes_)
    throw Error(Fault::internal, path_.string() + ": is shorter than that");
  flush();
  if (::lseek(descriptor_, 0, SEEK_SET) != 0) throw system_error(path_, "go back", errno);
  write_all(descriptor_, bytes, path_);
  if (::lseek(descriptor_, 0, SEEK_END) < 0) throw system_error(path_, "go back", errno);
}

void OutputFile::close() {
  flush();
  if (!sync_descriptor(descriptor_)) throw system_error(path_, "flush to disk", errno);
  if (::close(std::exchange(descriptor_, -1)) != 0) throw system_error(path_, "close", errno);
}

std::filesystem::path aside(const std::filesystem::path& path) {
  std::filesystem::path partial = path;
  partial += ".partial";
  return partial;
}

void write_whole_file(const std::filesystem::path& path, std::string_view bytes) {
  AsideFiles made;
  made.write(path, bytes);
  rename_path(aside(path), path);
}

void write_whole_files(const std::vector<WholeFile>& files) {
  AsideFiles made;
  for (const WholeFile& file : files) made.write(file.path, file.bytes);
  for (const WholeFile& file : files) rename_path(aside(file.path), file.path);
}

void sync_folder(const std::filesystem::path& folder) {
  const std::filesystem::path name = folder.empty() ? "." : folder;
  const int descriptor = ::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) throw system_error(name, "open", errno);
  const bool synced = sync_descriptor(descriptor);
  const int code = errno;
  ::close(descriptor);
  if (!synced) throw system_error(name, "flush to disk", code);
}

void rename_path(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) throw system_error(to, "put in place", errno);
}

}  // namespace kissmap
