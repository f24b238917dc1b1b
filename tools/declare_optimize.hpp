// SPDX-License-Identifier: MIT
#pragma once

#include "commands.hpp"

namespace CLI {
class App;
}

namespace kissmap {

/// Declares `kissmap optimize`; `command` receives what is given.
CLI::App& declare_optimize(CLI::App& app, OptimizeCommand& command);

}  // namespace kissmap
