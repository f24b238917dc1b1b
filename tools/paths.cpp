// SPDX-License-Identifier: MIT
#include "paths.hpp"

#include <system_error>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

/// Without links, dots and a separator at the end.
std::filesystem::path whole_path(const std::filesystem::path& path) {
  std::error_code unresolved;
  const std::filesystem::path whole = std::filesystem::weakly_canonical(path, unresolved);
  return whole.has_filename() ? whole : whole.parent_path();
}

}  // namespace

void require_apart(const std::filesystem::path& source,
                   const std::string& what,
                   const std::filesystem::path& session) {
  std::error_code unresolved;
  const auto whole_source = std::filesystem::weakly_canonical(source, unresolved);
  const auto whole_session = std::filesystem::weakly_canonical(session, unresolved);
  for (auto folder = whole_source; folder.has_relative_path(); folder = folder.parent_path()) {
    if (folder != whole_session) continue;
    throw usage_error(session.string() + ": holds " + what + " " + source.string() +
                      "; give another place for the session with -o");
  }
}

void require_outside(const std::filesystem::path& output,
                     const std::filesystem::path& source,
                     const std::string& what) {
  const std::filesystem::path whole_source = whole_path(source);
  std::filesystem::path folder = whole_path(output);
  while (folder != whole_source && folder.has_relative_path()) folder = folder.parent_path();
  if (folder != whole_source) return;
  throw usage_error(output.string() + ": is inside " + what + " " + source.string() +
                    "; give another place with -o");
}

}  // namespace kissmap
