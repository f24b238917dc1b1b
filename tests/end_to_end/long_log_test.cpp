// SPDX-License-Identifier: MIT
// Memory and time per scan must not grow with the log. KISSMAP_LONG=1: 20,000 scans, else 1,200.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <memory>

#include "kissmap/formats/session.hpp"
#include "kissmap/mapping/mapper.hpp"
#include "kissmap/version.hpp"
#include "simulator/simulator.hpp"
#include "simulator/tours.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using Clock = std::chrono::steady_clock;

std::size_t scan_count() {
  return std::getenv("KISSMAP_LONG") != nullptr ? 20'000 : 1'200;
}

double peak_mebibytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// A car going round and round four blocks, with a 16 x 900 sensor.
simulator::Simulator endless_drive(std::size_t scans) {
  simulator::Town town = simulator::make_town(1);
  std::vector<simulator::Crossing> route;
  // A round of some 620 m takes at least 62 s, 620 scans.
  for (std::size_t round = 0; round < scans / 620 + 2; ++round) {
    route.insert(route.end(), {{1, 1}, {3, 1}, {3, 3}, {1, 3}});
  }
  simulator::Motion motion = simulator::town_car_drive(town, 1, route);
  return {std::move(town.world), simulator::spinning_sensor(16, 900), std::move(motion), 1, scans};
}

TEST(LongLog, MemoryAndTimePerScanStayFlat) {
  const std::size_t scans = scan_count();
  const simulator::Simulator simulator = endless_drive(scans);
  ASSERT_EQ(simulator.scan_count(), scans);
  const TempDir temp;
  SessionWriter session(temp.path() / "session", false);
  ThreadPool pool;
  Mapper mapper({}, {}, pool);

  std::vector<double> milliseconds;  // mapping and writing, without simulating
  double settled_memory = 0.0;
  SessionManifest manifest;
  manifest.program_version = version();
  for (std::size_t i = 0; i < scans; ++i) {
    const Scan scan = simulator.scan(i);
    const Clock::time_point start = Clock::now();
    const MapperStep step = mapper.add(scan);
    session.add_scan({i, std::get<MappedScan>(step.scan)});
    if (step.closed) session.add_local_map(*step.closed);
    milliseconds.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    if (i == scans / 2) settled_memory = peak_mebibytes();
  }
  if (const auto last = mapper.finish()) session.add_local_map(*last);
  manifest.counts.scans_read = manifest.counts.scans_used = scans;
  session.finish(manifest);

  EXPECT_LT(peak_mebibytes(), 1024.0);
  // Local maps differ in size. Half a kilobyte a scan kept in 20,000 scans would be more than this.
  EXPECT_LT(peak_mebibytes(), settled_memory + 4.0) << "memory grows with the log";
  // Medians of the second and the last fifth: a law of the algorithm (no growth), with room for a
  // noisy machine.
  const auto fifth_median = [&](std::size_t fifth) {
    std::vector<double> part(
        milliseconds.begin() + static_cast<std::ptrdiff_t>(fifth * scans / 5),
        milliseconds.begin() + static_cast<std::ptrdiff_t>((fifth + 1) * scans / 5));
    std::ranges::nth_element(part, part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2));
    return part[part.size() / 2];
  };
  std::printf("%zu scans: peak %.0f MiB, median ms/scan by fifths %.2f %.2f %.2f %.2f %.2f\n",
              scans,
              peak_mebibytes(),
              fifth_median(0),
              fifth_median(1),
              fifth_median(2),
              fifth_median(3),
              fifth_median(4));
  EXPECT_LT(fifth_median(4), 2.0 * fifth_median(1)) << "scans take longer and longer";
}

}  // namespace
}  // namespace kissmap
