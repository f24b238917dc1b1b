// SPDX-License-Identifier: MIT
#pragma once

#include "commands.hpp"

namespace CLI {
class App;
}

namespace kissmap {

/// Declares `kissmap export-grid`; `command` receives what is given.
CLI::App& declare_export_grid(CLI::App& app, ExportGridCommand& command);

}  // namespace kissmap
