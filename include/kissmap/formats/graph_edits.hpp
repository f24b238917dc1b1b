// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kissmap/error.hpp"
#include "kissmap/graph/pose_graph.hpp"

namespace kissmap {

/// One change of a pose graph made by hand.
struct GraphEdit {
  enum class Verb : std::uint8_t { remove, fix, add };

  Verb verb = Verb::remove;
  std::int64_t from = 0;  ///< id of a node, not its index
  std::int64_t to = 0;
  std::optional<Rigid3> from_from_to;  ///< of add; of sessions only: nothing, find it yourself
  bool is_guess = false;               ///< of sessions only: the pose is near, not it
  double sigma_metres = 0.1;           ///< of add: standard deviation of each translation
  double sigma_radians = 0.01;         ///< of add: and of each rotation
  std::size_t line = 0;                ///< of the file, from 1
};

struct GraphEdits {
  std::filesystem::path path;  ///< for messages
  std::string text;            ///< of the file
  std::vector<GraphEdit> edits;

  /// Error(input) with file and line of an edit.
  Error error(const GraphEdit& edit, const std::string& message) const;
};

/// Reads one edit a line; blank lines and what follows a '#' do not count:
///     remove FROM TO
///     fix FROM TO
///     add FROM TO x y z qx qy qz qw [sigma_m sigma_rad]
///     add FROM TO [near x y z qx qy qz qw]
/// The last form is for sessions, which have local maps that can be registered.
/// Throws Error(input) with file and line.
GraphEdits read_graph_edits(const std::filesystem::path& path);

/// Applies the edits in order. `ids` names the nodes, ascending. remove and fix take every edge
/// between the two nodes, in either direction: remove drops them, fix makes them trusted. add adds
/// a closure, which can be refused unless a fix follows.
/// Throws Error(input) with file and line for unknown nodes, missing edges and missing poses.
void apply(const GraphEdits& edits, const std::vector<std::int64_t>& ids, PoseGraph& graph);

}  // namespace kissmap
