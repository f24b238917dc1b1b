// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

namespace kissmap {

/// Writing a session must not take with it what it is made from. Throws Error(usage) if `source`,
/// called `what` in the message, is the session's folder or inside it.
void require_apart(const std::filesystem::path& source,
                   const std::string& what,
                   const std::filesystem::path& session);

/// Throws Error(usage) if `output` is the folder or file `source`, called `what`, or inside it.
void require_outside(const std::filesystem::path& output,
                     const std::filesystem::path& source,
                     const std::string& what);

}  // namespace kissmap
