// SPDX-License-Identifier: MIT
#pragma once

namespace kissmap {

/// Program version, "major.minor.patch". Static storage.
const char* version();

}  // namespace kissmap
