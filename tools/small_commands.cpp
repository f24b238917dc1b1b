// SPDX-License-Identifier: MIT
#include <cstdio>

#include "commands.hpp"
#include "kissmap/formats/registry.hpp"
#include "kissmap/formats/session.hpp"
#include "report.hpp"

namespace kissmap {

void pack(const PackCommand& command) {
  const PackSummary summary = pack_session(command.session, command.log);
  std::printf("%s\n  pack        %s\n", command.session.c_str(), describe(summary).c_str());
}

void list_formats() {
  for (const LogFormat& format : log_formats()) {
    std::printf("%-16s %s\n%-16s   %s\n", format.name, format.description, "", format.layout);
  }
}

void print_default_configuration() {
  std::fputs(to_toml(Configuration{}).c_str(), stdout);
}

}  // namespace kissmap
