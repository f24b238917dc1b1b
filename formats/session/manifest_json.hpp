// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "kissmap/formats/session.hpp"

namespace kissmap {

/// What session.json holds beside the manifest, to tell whole tables from cut ones.
struct TableSizes {
  std::uint64_t scans = 0;
  std::uint64_t local_maps = 0;
  // Of what the run measured, edits by hand apart. Sessions of before 'kissmap optimize' lack them.
  std::optional<std::uint64_t> closures;
  std::optional<std::uint64_t> neighbors;
  std::optional<std::uint64_t> surfaces;
};

struct StoredManifest {
  SessionManifest manifest;  ///< configuration included, though it is a file of its own
  bool finished = false;
  bool optimizing = false;  ///< not finished only because 'kissmap optimize' was stopped
  TableSizes tables;
};

/// Text of session.json. Throws Error(internal) when a number is not finite.
std::string manifest_text(const StoredManifest& stored);

/// Reads session.json and config.toml of a folder; of an unfinished session, what is there.
/// Throws Error(input) naming file, place and cure.
StoredManifest read_manifest(const std::filesystem::path& session);

/// True if the folder's session.json says that it is one of a session. Never throws.
bool has_session_manifest(const std::filesystem::path& folder);

/// Writes config.toml, then session.json. Throws Error(output).
void write_manifest(const StoredManifest& stored, const std::filesystem::path& session);

/// JSON knows UTF-8 only; other bytes, as in some file names, come back as U+FFFD.
std::string as_json_stores_it(const std::string& text);

}  // namespace kissmap
