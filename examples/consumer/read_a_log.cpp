// SPDX-License-Identifier: MIT
// Any log kissmap reads, scan by scan. Links kissmap::formats.
#include <cstdio>
#include <kissmap/error.hpp>
#include <kissmap/formats/registry.hpp>

int main(int argc, char** argv) {
  if (argc != 2) {
    std::printf("usage: read_a_log LOG\nformats:");
    for (const kissmap::LogFormat& format : kissmap::log_formats()) std::printf(" %s", format.name);
    std::printf("\n");
    return argc == 1 ? 0 : 2;
  }
  try {
    const auto log = kissmap::open_log(argv[1]);
    while (const auto entry = log->next()) {
      if (const auto* scan = std::get_if<kissmap::Scan>(&entry->content)) {
        std::printf("%s: %zu points\n", entry->name.c_str(), scan->points.size());
      }
    }
  } catch (const kissmap::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.fault());
  }
  return 0;
}
