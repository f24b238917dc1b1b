// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace kissmap {

/// Appends `bytes` packed as LZF. What is appended piece by piece unpacks to the pieces in a row.
/// Depends on the bytes alone, which liblzf's own lzf_compress does not promise: it starts from
/// whatever its table held before.
void append_lzf(std::string_view bytes, std::string& packed);

}  // namespace kissmap
