// SPDX-License-Identifier: MIT
#pragma once

#include "commands.hpp"

namespace CLI {
class App;
}

namespace kissmap {

/// Declares `kissmap eval`; `command` receives what is given.
CLI::App& declare_eval(CLI::App& app, EvalCommand& command);

}  // namespace kissmap
