// SPDX-License-Identifier: MIT
// Loop closing at city scale: one query's look-up among up to 20,000 local maps, and its recall.
#include <benchmark/benchmark.h>

#include <map>
#include <memory>
#include <random>

#include "kissmap/loop_closing/descriptor_forest.hpp"

namespace kissmap {
namespace {

constexpr std::size_t features = 120;  // of a local map of 30 m in a simulated town
constexpr int changed_bits = 30;       // between two looks at one feature
constexpr int max_distance = 50;

struct City {
  DescriptorForest forest;
  std::vector<Descriptor> query;  ///< the features of one of its local maps, changed
  std::uint32_t revisited = 0;
};

/// The same city for the same size. Bits of real descriptors are not independent: each one here is
/// a mix of 64 patterns, so that unlike places share some of them.
const City& city(std::uint32_t local_maps) {
  static std::map<std::uint32_t, std::unique_ptr<City>> cities;
  std::unique_ptr<City>& made = cities[local_maps];
  if (made) return *made;
  made = std::make_unique<City>();
  made->revisited = local_maps / 3;
  std::mt19937_64 random(1);
  std::vector<Descriptor> patterns(64);
  for (Descriptor& pattern : patterns) {
    for (std::uint64_t& word : pattern) word = random();
  }
  std::vector<Descriptor> descriptors(features);
  for (std::uint32_t id = 0; id < local_maps; ++id) {
    for (Descriptor& descriptor : descriptors) {
      const Descriptor& pattern = patterns[random() % patterns.size()];
      // A bit is the pattern's three times out of four.
      for (std::size_t w = 0; w < 4; ++w) descriptor[w] = pattern[w] ^ (random() & random());
    }
    made->forest.add(id, descriptors);
    if (id == made->revisited) made->query = descriptors;
  }
  for (Descriptor& descriptor : made->query) {
    for (int i = 0; i < changed_bits; ++i) {
      const std::uint64_t bit = random() % 256;
      descriptor[bit / 64] ^= std::uint64_t{1} << (bit % 64);
    }
  }
  return *made;
}

void place_look_up(benchmark::State& state) {
  const auto local_maps = static_cast<std::uint32_t>(state.range(0));
  const City& c = city(local_maps);
  std::size_t found = 0;
  for (auto _ : state) {
    found = 0;
    for (const Descriptor& descriptor : c.query) {
      for (const auto& match : c.forest.search(descriptor, max_distance, local_maps)) {
        if (match.entry.place == c.revisited) ++found;
      }
    }
  }
  state.counters["recall"] = static_cast<double>(found) / features;  // brute force finds all
  state.counters["MiB"] = static_cast<double>(c.forest.memory_bytes()) / (1 << 20);
}
BENCHMARK(place_look_up)->Arg(312)->Arg(1250)->Arg(5000)->Arg(20000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kissmap

BENCHMARK_MAIN();
