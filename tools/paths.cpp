// SPDX-License-Identifier: MIT
#include "paths.hpp"

#include <system_error>

#include "kissmap/error.hpp"

namespace kissmap {

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

}  // namespace kissmap
