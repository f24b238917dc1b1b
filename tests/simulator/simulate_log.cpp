// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "kissmap/error.hpp"
#include "simulator/log_folder.hpp"
#include "simulator/scenario.hpp"

namespace {

using namespace kissmap;
using namespace kissmap::simulator;

struct Options {
  Scenario scenario;
  int threads = 0;
  bool labels = false;
  std::string folder;
};

void bind(CLI::App& app, Options& options) {
  Scenario& s = options.scenario;
  app.option_defaults()->always_capture_default();
  app.add_option("--world", s.world, "where: town, office, garage (two levels) or hill");
  app.add_option("--sensor", s.sensor, "spinning16, spinning32, spinning64, rosette or raster");
  app.add_option("--motion",
                 s.motion,
                 "who carries it: car, car-opposite (meets its way in the opposite direction; only "
                 "in town), handheld or robot (these two only in town and office; no car in an "
                 "office)");
  app.add_option("--seed", s.seed, "of world, motion and noise");
  app.add_option("--scans", s.scans, "number of sweeps of 0.1 s; 0: the whole tour");
  app.add_option("--columns", s.columns, "shots a turn or line; 0: usual for the sensor")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--movers",
                 s.movers,
                 "people and cars on the move, none standing for long, in town or office; without "
                 "it 74 in town and 4 in an office")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--labels", options.labels, "also write what each point truly lies on");
  app.add_option(
         "--threads", options.threads, "0: one for each processor; never changes the result")
      ->check(CLI::NonNegativeNumber);
  app.add_option("-o,--output", options.folder, "folder to make")->required();
}

int simulate(const Options& options) {
  const Simulator simulator = make_simulator(options.scenario);
  const std::size_t count = simulator.scan_count();
  const bool terminal = isatty(STDERR_FILENO) == 1;
  write_log_folder(
      simulator,
      options.folder,
      options.threads,
      [&](std::size_t done) {
        if (terminal) std::fprintf(stderr, "\r%zu of %zu scans", done, count);
      },
      options.labels);
  if (terminal) std::fprintf(stderr, "\r\033[K");
  std::printf("%s: %zu scans and truth.tum\n", options.folder.c_str(), count);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Simulates a LiDAR log with exact ground truth.", "kissmap-simulate"};
  Options options;
  bind(app, options);
  try {
    app.parse(argc, argv);
    return simulate(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(Fault::usage);
  } catch (const Error& error) {
    std::fprintf(stderr, "kissmap-simulate: %s\n", error.what());
    return static_cast<int>(error.fault());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kissmap-simulate: %s\n", error.what());
    return static_cast<int>(Fault::internal);
  }
}
