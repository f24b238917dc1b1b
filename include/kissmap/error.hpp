// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace kissmap {

/// Whose turn it is to act on an error. The values are the program's exit codes.
enum class Fault {
  internal = 1,  ///< a defect of kissmap, or the machine ran out of something
  usage = 2,     ///< the command line or the configuration
  input = 3,     ///< a log or session that cannot be read
  output = 4,    ///< a place that cannot be written
};

/// The only exception the libraries throw on purpose.
/// The message names the file, the place in it and the cure.
class Error : public std::runtime_error {
 public:
  Error(Fault fault, const std::string& message) : std::runtime_error(message), fault_(fault) {}
  Fault fault() const { return fault_; }

 private:
  Fault fault_;
};

inline Error usage_error(const std::string& message) {
  return {Fault::usage, message};
}
inline Error input_error(const std::filesystem::path& path, const std::string& message) {
  return {Fault::input, path.string() + ": " + message};
}
inline Error output_error(const std::filesystem::path& path, const std::string& message) {
  return {Fault::output, path.string() + ": " + message};
}

}  // namespace kissmap
