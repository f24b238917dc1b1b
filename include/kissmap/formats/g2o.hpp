// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kissmap/graph/pose_graph.hpp"

namespace kissmap {

/// What to do with an edge whose information is negative in some direction, so that no pose is of
/// least cost: an error, or keep its translation and rotation blocks and drop what couples them.
enum class NegativeInformation : std::uint8_t { refuse, drop_coupling };

/// A pose graph with the names its file gives to things.
struct GraphFile {
  PoseGraph graph;
  std::vector<std::int64_t> ids;                 ///< of the nodes, ascending
  bool has_start = false;                        ///< whether the file gives start values
  std::map<std::string, std::uint64_t> skipped;  ///< lines left out, by their unknown tag
  std::uint64_t couplings_dropped = 0;           ///< edges changed by drop_coupling
};

/// Index of the node `id`, or nothing.
std::optional<std::uint32_t> node_of(const GraphFile& file, std::int64_t id);

/// Reads VERTEX_SE3:QUAT, EDGE_SE3:QUAT, VERTEX_SE2, EDGE_SE2 and FIX lines (g2o, Kuemmerle et al.,
/// ICRA 2011). Information in quaternion-vector units is brought to rotation vectors: a quarter in
/// the rotation block, half beside it. A file of SE2 lines becomes a planar graph. Without vertices
/// the nodes are those of the edges, at the identity. Edges between consecutive ids are odometry,
/// all others closures. Without FIX the node of the lowest id is fixed. Other tags are counted.
/// Throws Error(input) with file and line for anything else.
GraphFile read_g2o(const std::filesystem::path& path,
                   NegativeInformation negative = NegativeInformation::refuse);

/// Writes the same, in order of the ids and edges; numbers read back exactly (angles of planar
/// vertices within rounding). Edges of weight 0, if there are `edge_weights`, become comments that
/// begin "# refused". Written aside, then renamed. Throws Error(output).
void write_g2o(const GraphFile& file,
               const std::filesystem::path& path,
               const std::vector<double>& edge_weights = {});

}  // namespace kissmap
