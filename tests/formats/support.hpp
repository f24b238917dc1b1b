// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "kissmap/error.hpp"
#include "kissmap/formats/registry.hpp"

namespace kissmap::test {

namespace fs = std::filesystem;

/// A folder that vanishes with the test.
class TempDir {
 public:
  TempDir() {
    std::string name = (fs::temp_directory_path() / "kissmap_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TempDir() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;
  const fs::path& path() const { return path_; }

  fs::path write(const std::string& name, std::string_view content) const {
    const fs::path file = path_ / name;
    fs::create_directories(file.parent_path());
    fs::remove(file);  // some file systems flush to disk when a file is emptied in place
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }

 private:
  fs::path path_;
};

/// Bytes of numbers in a chosen byte order.
class Bytes {
 public:
  explicit Bytes(std::endian order = std::endian::little) : order_(order) {}

  template <class T>
  Bytes& add(std::type_identity_t<T> value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if (order_ != std::endian::native) std::reverse(bytes, bytes + sizeof(T));
    text_.append(bytes, sizeof(T));
    return *this;
  }
  Bytes& pad(std::size_t count) {
    text_.append(count, '\x5a');
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  std::endian order_;
  std::string text_;
};

inline std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

inline std::vector<LogEntry> read_all(ScanLog& log) {
  std::vector<LogEntry> entries;
  while (auto entry = log.next()) entries.push_back(std::move(*entry));
  return entries;
}

/// The scan of an entry; a test that meets a refusal instead fails with its text.
inline const Scan& scan_of(const LogEntry& entry) {
  if (const auto* refused = std::get_if<RefusedScan>(&entry.content)) {
    throw std::runtime_error("refused: " + refused->reason + ": " + refused->detail);
  }
  const Scan& scan = std::get<Scan>(entry.content);
  require_consistent(scan);
  return scan;
}

inline const RefusedScan& refusal_of(const LogEntry& entry) {
  return std::get<RefusedScan>(entry.content);
}

/// The text of the Error a call must throw, with its fault checked.
template <class Call>
std::string error_of(Fault fault, Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), fault) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no Error was thrown";
  return {};
}

/// Runs another program, which has to succeed.
inline void run(const std::string& command) {
  ASSERT_EQ(std::system((command + " > /dev/null 2>&1").c_str()), 0) << command;
}

}  // namespace kissmap::test
