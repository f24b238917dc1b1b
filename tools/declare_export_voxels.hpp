// SPDX-License-Identifier: MIT
#pragma once

#include "commands.hpp"

namespace CLI {
class App;
}

namespace kissmap {

/// Declares `kissmap export-voxels`; `command` receives what is given.
CLI::App& declare_export_voxels(CLI::App& app, ExportVoxelsCommand& command);

}  // namespace kissmap
