// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/loop_editor.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

constexpr double farthest = 1e5;  // m, of a pose given by hand
// Guesses around one that leads nowhere. The registration itself reaches one to two metres.
constexpr int search_steps = 3;
constexpr double search_step = 2.0;  // m

Error refusal(const std::string& message) {
  return {Fault::input, message};
}

std::string names(std::uint32_t from, std::uint32_t to) {
  return std::to_string(from) + " and " + std::to_string(to);
}

/// Pose of the query in the reference's frame from that of `to` in `from`.
Rigid3 ordered(const Rigid3& from_from_to, std::uint32_t from, std::uint32_t to) {
  if (!(from_from_to.translation.norm() <= farthest)) {
    throw refusal("the pose is farther away than 100 km");
  }
  return to > from ? from_from_to : from_from_to.inverse();
}

std::string figures(const Closure& closure) {
  char text[120];
  std::snprintf(text,
                sizeof(text),
                "overlap %.2f, steep surfaces agree by %.2f, residual %.2f m",
                closure.overlap,
                closure.wall_agreement,
                closure.residual_after);
  return text;
}

std::vector<Rigid3> guesses_around(const Rigid3& guess) {
  std::vector<Rigid3> guesses;
  for (int x = -search_steps; x <= search_steps; ++x) {
    for (int y = -search_steps; y <= search_steps; ++y) {
      for (int z = -search_steps; z <= search_steps; ++z) {
        const Eigen::Vector3d steps(x, y, z);
        if (steps.norm() > search_steps) continue;
        guesses.push_back({guess.rotation, guess.translation + search_step * steps});
      }
    }
  }
  return guesses;
}

/// From the guess; if that leads nowhere, the outcome of largest overlap from guesses around it.
Closure find_fit(const SurfelCloud& query,
                 const SurfelReference& reference,
                 const Rigid3& guess,
                 const ClosureValidationOptions& options) {
  Closure best = validate_closure(query, reference, guess, options);
  if (best.verdict == ClosureVerdict::accepted) return best;
  for (const Rigid3& other : guesses_around(guess)) {
    const Closure closure = validate_closure(query, reference, other, options);
    if (closure.verdict != ClosureVerdict::accepted) continue;
    const bool first = best.verdict != ClosureVerdict::accepted;
    if (first || closure.overlap > best.overlap) best = closure;
  }
  return best;
}

}  // namespace

LoopEditor::LoopEditor(LoopEvidence evidence,
                       std::vector<ScanPlace> scans,
                       const ClosureValidationOptions& validation,
                       double voxel_size,
                       SurfelSource surfels)
    : evidence_(std::move(evidence)),
      scans_(std::move(scans)),
      validation_((require_valid(validation), validation)),
      voxel_size_(voxel_size),
      surfels_(std::move(surfels)) {
}

void LoopEditor::remove(std::uint32_t from, std::uint32_t to) {
  const Pair pair = pair_of(from, to);
  const std::vector<std::size_t> found = find(pair, true);
  if (found.empty()) {
    const std::vector<std::size_t> refused = find(pair, false);
    if (refused.empty()) throw refusal("there is no closure between " + names(from, to));
    throw refusal("the closure between " + names(from, to) +
                  " is refused already: " + reason(evidence_.closures[refused.back()]));
  }
  for (const std::size_t i : found) {
    Closure& closure = evidence_.closures[i];
    closure.trusted = false;
    closure.verdict = closure.first_verdict == ClosureVerdict::accepted
                          ? ClosureVerdict::removed_by_hand
                          : closure.first_verdict;
  }
  std::erase_if(evidence_.closures, [](const Closure& closure) {
    return closure.source == ClosureSource::hand && !enters_graph(closure);
  });
  correction_.reset();
}

void LoopEditor::fix(std::uint32_t from, std::uint32_t to) {
  const Pair pair = pair_of(from, to);
  std::vector<std::size_t> found = find(pair, true);
  if (found.empty()) {
    found = find(pair, false);
    std::erase_if(found, [this](std::size_t i) {
      return evidence_.closures[i].verdict == ClosureVerdict::removed_by_hand;
    });
    if (found.empty()) {
      throw refusal("there is no closure and no candidate between " + names(from, to) +
                    "; add one");
    }
    found = {*std::ranges::max_element(
        found, {}, [this](std::size_t i) { return evidence_.closures[i].overlap; })};
  }
  for (const std::size_t i : found) {
    evidence_.closures[i].trusted = true;
    evidence_.closures[i].verdict = ClosureVerdict::accepted;
  }
  correction_.reset();
}

void LoopEditor::add(std::uint32_t from,
                     std::uint32_t to,
                     const Rigid3& from_from_to,
                     const ClosureSigmas& sigmas) {
  const Pair pair = open_pair(from, to);
  Closure closure =
      measure_closure(surfels_(pair.query), reference_of(pair), ordered(from_from_to, from, to));
  closure.sigmas = sigmas;
  closure.information = information_of(closure);
  append(pair, closure);
}

void LoopEditor::join(std::uint32_t from,
                      std::uint32_t to,
                      const std::optional<Rigid3>& guess_from_from_to) {
  const Pair pair = open_pair(from, to);
  const auto present = [this, from, to] {
    const std::vector<Rigid3>& keyposes = correction().map_from_local_map;
    return keyposes[from].inverse() * keyposes[to];
  };
  const Rigid3 guess = ordered(guess_from_from_to ? *guess_from_from_to : present(), from, to);
  const Closure closure = find_fit(surfels_(pair.query), reference_of(pair), guess, validation_);
  if (closure.verdict != ClosureVerdict::accepted) {
    throw refusal("the local maps " + names(from, to) + " do not fit together from " +
                  (guess_from_from_to ? "this guess" : "where they lie now") + ": " +
                  to_string(closure.verdict) + " (" + figures(closure) +
                  "); give a better guess with 'near', or the pose itself");
  }
  append(pair, closure);
}

const LoopCorrection& LoopEditor::correction() {
  if (!correction_) correction_ = correct_loops(scans_, evidence_);
  return *correction_;
}

LoopEditor::Pair LoopEditor::pair_of(std::uint32_t from, std::uint32_t to) const {
  const std::size_t count = evidence_.map_from_local_map.size();
  for (const std::uint32_t id : {from, to}) {
    if (id < count) continue;
    throw refusal("there is no local map " + std::to_string(id) + ", only 0 to " +
                  std::to_string(count - 1));
  }
  if (from == to) throw refusal("a local map has no closure with itself");
  return {std::max(from, to), std::min(from, to)};
}

LoopEditor::Pair LoopEditor::open_pair(std::uint32_t from, std::uint32_t to) const {
  const Pair pair = pair_of(from, to);
  if (find(pair, true).empty()) return pair;
  throw refusal("there is a closure between " + names(from, to) +
                " already; remove it first to replace it");
}

/// Numbers of the pair's candidates that enter the graph, or of the others.
std::vector<std::size_t> LoopEditor::find(const Pair& pair, bool in_graph) const {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < evidence_.closures.size(); ++i) {
    const Closure& closure = evidence_.closures[i];
    const bool meant = closure.query_id == pair.query && closure.reference_id == pair.reference;
    if (meant && enters_graph(closure) == in_graph) found.push_back(i);
  }
  return found;
}

SurfelReference LoopEditor::reference_of(const Pair& pair) const {
  return {surfels_(pair.reference), voxel_size_};
}

void LoopEditor::append(const Pair& pair, Closure closure) {
  closure.query_id = pair.query;
  closure.reference_id = pair.reference;
  closure.source = ClosureSource::hand;
  evidence_.closures.push_back(closure);
  correction_.reset();
}

}  // namespace kissmap
