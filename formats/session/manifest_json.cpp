// SPDX-License-Identifier: MIT
#include "formats/session/manifest_json.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "formats/files/output_file.hpp"
#include "formats/files/xxh3.hpp"
#include "formats/session/manifest_fields.hpp"
#include "formats/session/session_folder.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr const char* format_mark = "kissmap session";

std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw input_error(path, std::string("cannot be opened; ") + damaged_session_cure);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

std::string dump(const ordered_json& value) {
  return value.dump(2, ' ', false, json::error_handler_t::replace) + '\n';
}

void require_known_version(const json& root, const std::filesystem::path& path) {
  const std::uint64_t version = unsigned_field(root, "format_version");
  if (version == session_format_version) return;
  throw input_error(path,
                    "format version " + std::to_string(version) +
                        " of the session is not the version " +
                        std::to_string(session_format_version) +
                        " this program reads; use the kissmap that made it (see "
                        "program_version there) or a newer one");
}

// The text is a file of its own, for people; the manifest holds what it must hash to.
std::string read_configuration(const json& root, const std::filesystem::path& session) {
  const std::filesystem::path path = session / configuration_file_name;
  std::string text = read_text(path);
  if (xxh3_hex(text) != string_field(root, "configuration_xxh3")) {
    throw input_error(
        path, std::string("was changed after the session was made; ") + damaged_session_cure);
  }
  return text;
}

std::optional<std::uint64_t> optional_count(const json& object, const char* name) {
  if (!object.contains(name)) return std::nullopt;
  return unsigned_field(object, name);
}

StoredManifest parse(const json& root, const std::filesystem::path& session) {
  StoredManifest stored;
  SessionManifest& manifest = stored.manifest;
  stored.finished = bool_field(root, "finished");
  manifest.program_version = string_field(root, "program_version");
  if (root.contains("optimizing")) stored.optimizing = bool_field(root, "optimizing");
  if (!stored.finished && !stored.optimizing) return stored;
  manifest.log = log_from_json(root.at("log"));
  manifest.configuration = read_configuration(root, session);
  manifest.counts = counts_from_json(root.at("counts"));
  manifest.path_length = number_field(root, "path_length");
  if (const json& pack = root.at("pack"); !pack.is_null()) manifest.pack = pack_from_json(pack);
  stored.tables.scans = unsigned_field(root.at("tables"), "scans");
  stored.tables.local_maps = unsigned_field(root.at("tables"), "local_maps");
  stored.tables.closures = optional_count(root.at("tables"), "closures");
  stored.tables.neighbors = optional_count(root.at("tables"), "neighbors");
  stored.tables.surfaces = optional_count(root.at("tables"), "surfaces");
  return stored;
}

}  // namespace

std::string manifest_text(const StoredManifest& stored) {
  const SessionManifest& manifest = stored.manifest;
  ordered_json root;
  root["format"] = format_mark;
  root["format_version"] = session_format_version;
  root["finished"] = stored.finished;
  if (stored.optimizing) root["optimizing"] = true;
  root["program_version"] = manifest.program_version;
  root["log"] = log_to_json(manifest.log);
  root["configuration_xxh3"] = xxh3_hex(manifest.configuration);
  root["counts"] = counts_to_json(manifest.counts);
  root["path_length"] = finite(manifest.path_length, "path_length");
  root["pack"] = manifest.pack ? pack_to_json(*manifest.pack) : ordered_json();
  root["tables"] = {{"scans", stored.tables.scans}, {"local_maps", stored.tables.local_maps}};
  if (stored.tables.closures) root["tables"]["closures"] = *stored.tables.closures;
  if (stored.tables.neighbors) root["tables"]["neighbors"] = *stored.tables.neighbors;
  if (stored.tables.surfaces) root["tables"]["surfaces"] = *stored.tables.surfaces;
  return dump(root);
}

StoredManifest read_manifest(const std::filesystem::path& session) {
  const std::filesystem::path path = session / manifest_file_name;
  const std::string text = read_text(path);
  try {
    const json root = json::parse(text);
    if (string_field(root, "format") != format_mark) {
      throw input_error(path, "is not the manifest of a kissmap session; give another folder");
    }
    require_known_version(root, path);
    return parse(root, session);
  } catch (const json::exception& error) {
    throw input_error(path, std::string(error.what()) + "; " + damaged_session_cure);
  }
}

bool has_session_manifest(const std::filesystem::path& folder) try {
  const json root = json::parse(read_text(folder / manifest_file_name), nullptr, false);
  return root.is_object() && root.value("format", "") == format_mark;
} catch (const std::exception&) {
  return false;
}

void write_manifest(const StoredManifest& stored, const std::filesystem::path& session) {
  const std::string text = manifest_text(stored);
  write_whole_file(session / configuration_file_name, stored.manifest.configuration);
  write_whole_file(session / manifest_file_name, text);
}

std::string as_json_stores_it(const std::string& text) {
  const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 128; };
  if (std::ranges::all_of(text, is_ascii)) return text;
  return json::parse(ordered_json(text).dump(-1, ' ', false, json::error_handler_t::replace))
      .get<std::string>();
}

}  // namespace kissmap
