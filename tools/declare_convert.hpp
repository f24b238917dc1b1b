// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>

#include "commands.hpp"

namespace kissmap {

/// Declares `kissmap convert`.
CLI::App& declare_convert(CLI::App& app, ConvertCommand& command);

}  // namespace kissmap
