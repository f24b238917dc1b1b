// SPDX-License-Identifier: MIT
#include <cmath>
#include <numbers>

#include "formats/files/output_file.hpp"
#include "formats/files/table.hpp"
#include "formats/graphs/g2o_units.hpp"
#include "kissmap/formats/g2o.hpp"

namespace kissmap {
namespace {

void append_planar_pose(std::string& text, const Rigid3& pose) {
  append_number(text, pose.translation.x());
  text += ' ';
  append_number(text, pose.translation.y());
  text += ' ';
  append_number(text,
                std::remainder(2.0 * std::atan2(pose.rotation.z(), pose.rotation.w()),
                               2.0 * std::numbers::pi));
}

void append_information(std::string& text, const PoseGraphEdge& edge, bool planar) {
  const Information information = planar ? edge.information : information_to_g2o(edge.information);
  const int rows = planar ? 3 : 6;
  for (int row = 0; row < rows; ++row) {
    for (int column = row; column < rows; ++column) {
      text += ' ';
      append_number(
          text,
          planar ? information(planar_rows[row], planar_rows[column]) : information(row, column));
    }
  }
}

void append_line(std::string& text, const char* tag, std::initializer_list<std::int64_t> ids) {
  text += tag;
  for (const std::int64_t id : ids) {
    text += ' ';
    append_number(text, id);
  }
}

}  // namespace

void write_g2o(const GraphFile& file,
               const std::filesystem::path& path,
               const std::vector<double>& edge_weights) {
  const PoseGraph& graph = file.graph;
  const bool planar = graph.space == GraphSpace::planar;
  const auto append = [planar](std::string& text, const Rigid3& pose) {
    text += ' ';
    planar ? append_planar_pose(text, pose) : append_pose(text, pose, ' ');
  };
  std::string text;
  for (std::size_t i = 0; i < graph.map_from_node.size(); ++i) {
    append_line(text, planar ? "VERTEX_SE2" : "VERTEX_SE3:QUAT", {file.ids[i]});
    append(text, graph.map_from_node[i]);
    text += '\n';
  }
  for (const std::uint32_t node : graph.fixed) {
    append_line(text, "FIX", {file.ids[node]});
    text += '\n';
  }
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    const PoseGraphEdge& edge = graph.edges[i];
    if (i < edge_weights.size() && edge_weights[i] == 0.0) text += "# refused ";
    append_line(
        text, planar ? "EDGE_SE2" : "EDGE_SE3:QUAT", {file.ids[edge.from], file.ids[edge.to]});
    append(text, edge.from_from_to);
    append_information(text, edge, planar);
    text += '\n';
  }
  write_whole_file(path, text);
}

}  // namespace kissmap
