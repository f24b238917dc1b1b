// SPDX-License-Identifier: MIT
#pragma once

#include <gmock/gmock.h>

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "kissmap/error.hpp"
#include "kissmap/formats/session.hpp"

namespace kissmap {

/// Any pose within 1 km, with numbers that use all their digits.
Rigid3 random_pose(std::mt19937& random);

/// A session with awkward values everywhere: negative and extreme stamps, texts that need
/// escaping, skipped log indices, an empty local map.
Session example_session();
std::vector<SurfelCloud> example_surfels();

/// Writes it through SessionWriter, scans before the local map they belong to.
void write_session(const Session& session,
                   const std::vector<SurfelCloud>& surfels,
                   const std::filesystem::path& path,
                   bool overwrite = false);

std::string read_file(const std::filesystem::path& path);
void write_file(const std::filesystem::path& path, const std::string& bytes);

/// The Error a call throws, as "fault: message", or "no error".
template <typename Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    constexpr const char* faults[] = {"", "internal", "usage", "input", "output"};
    return std::string(faults[static_cast<int>(error.fault())]) + ": " + error.what();
  }
  return "no error";
}

}  // namespace kissmap
