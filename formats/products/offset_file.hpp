// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>

namespace kissmap {

/// "# add to x y z ...": the text of an offset file.
std::string offset_text(const Eigen::Vector3d& offset);

/// Writes OUTPUT.offset.txt, which says what coordinates in OUTPUT lack, and returns its path; for
/// no offset returns nothing, and removes the file that belonged to a map now replaced, which would
/// move the new one. Throws Error(output).
std::filesystem::path write_offset_file(const std::filesystem::path& output,
                                        const Eigen::Vector3d& offset);

}  // namespace kissmap
