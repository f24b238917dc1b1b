// SPDX-License-Identifier: MIT
#pragma once

#include "commands.hpp"

namespace CLI {
class App;
}

namespace kissmap {

/// Declares `kissmap export-cloud`; `command` receives what is given.
CLI::App& declare_export_cloud(CLI::App& app, ExportCloudCommand& command);

}  // namespace kissmap
