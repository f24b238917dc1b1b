// SPDX-License-Identifier: MIT
#include "kissmap/formats/graph_edits.hpp"

#include <algorithm>
#include <string>

#include "formats/files/input_file.hpp"
#include "formats/graphs/line_fields.hpp"
#include "formats/text/lines.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

double sigma(LineFields& fields, const char* name) {
  constexpr double least = 1e-9;
  constexpr double most = 1e9;
  const double value = fields.number(name);
  if (value >= least && value <= most) return value;
  throw fields.error(std::string(name) + " is a standard deviation, 1e-9 to 1e9");
}

void read_pose(LineFields& fields, GraphEdit& edit) {
  edit.is_guess = fields.take("near");
  edit.from_from_to = fields.pose();
  if (edit.is_guess || fields.at_end()) return;
  edit.sigma_metres = sigma(fields, "sigma_m");
  edit.sigma_radians = sigma(fields, "sigma_rad");
}

GraphEdit read_edit(LineFields& fields, std::size_t line) {
  GraphEdit edit;
  edit.line = line;
  const std::string_view verb = fields.word();
  if (verb == "remove") {
    edit.verb = GraphEdit::Verb::remove;
  } else if (verb == "fix") {
    edit.verb = GraphEdit::Verb::fix;
  } else if (verb == "add") {
    edit.verb = GraphEdit::Verb::add;
  } else {
    throw fields.error("unknown edit " + in_quotes(verb) + "; known are remove, fix and add");
  }
  edit.from = fields.id("FROM");
  edit.to = fields.id("TO");
  if (edit.from == edit.to) throw fields.error("FROM and TO are the same");
  if (edit.verb == GraphEdit::Verb::add && !fields.at_end()) read_pose(fields, edit);
  fields.end();
  return edit;
}

/// The edit at work: nodes found, errors with file and line.
struct Edit {
  const GraphEdits& edits;
  const GraphEdit& edit;
  const std::vector<std::int64_t>& ids;

  Error error(const std::string& message) const { return edits.error(edit, message); }
  std::uint32_t node(std::int64_t id) const {
    const auto place = std::ranges::lower_bound(ids, id);
    if (place == ids.end() || *place != id) {
      throw error("there is no node " + std::to_string(id));
    }
    return static_cast<std::uint32_t>(place - ids.begin());
  }
};

PoseGraphEdge edge_of(const Edit& e, const PoseGraph& graph) {
  if (!e.edit.from_from_to || e.edit.is_guess) {
    throw e.error("only in a session can kissmap find the pose; give x y z qx qy qz qw");
  }
  const Rigid3& pose = *e.edit.from_from_to;
  if (graph.space == GraphSpace::planar &&
      (pose.translation.z() != 0.0 || pose.rotation.x() != 0.0 || pose.rotation.y() != 0.0)) {
    throw e.error("the graph is planar: z, qx and qy must be 0");
  }
  PoseGraphEdge edge{e.node(e.edit.from), e.node(e.edit.to), pose, {}, EdgeKind::closure};
  Twist diagonal;
  diagonal.head<3>().setConstant(1.0 / (e.edit.sigma_metres * e.edit.sigma_metres));
  diagonal.tail<3>().setConstant(1.0 / (e.edit.sigma_radians * e.edit.sigma_radians));
  edge.information = diagonal.asDiagonal();
  return edge;
}

void apply_one(const Edit& e, PoseGraph& graph) {
  if (e.edit.verb == GraphEdit::Verb::add) {
    graph.edges.push_back(edge_of(e, graph));
    return;
  }
  const std::uint32_t a = e.node(e.edit.from);
  const std::uint32_t b = e.node(e.edit.to);
  const auto meant = [a, b](const PoseGraphEdge& edge) {
    return (edge.from == a && edge.to == b) || (edge.from == b && edge.to == a);
  };
  if (std::ranges::none_of(graph.edges, meant)) {
    throw e.error("there is no edge between " + std::to_string(e.edit.from) + " and " +
                  std::to_string(e.edit.to));
  }
  if (e.edit.verb == GraphEdit::Verb::remove) {
    std::erase_if(graph.edges, meant);
    return;
  }
  for (PoseGraphEdge& edge : graph.edges) {
    if (meant(edge)) edge.kind = EdgeKind::odometry;
  }
}

}  // namespace

Error GraphEdits::error(const GraphEdit& edit, const std::string& message) const {
  return LineFields(path, edit.line, "").error(message);
}

GraphEdits read_graph_edits(const std::filesystem::path& path) {
  GraphEdits edits;
  edits.path = path;
  const std::vector<std::byte> bytes = read_side_file(path);
  edits.text = text_of(bytes);
  Lines lines(edits.text);
  while (const auto line = lines.next()) {
    const std::string_view text = trimmed(line->substr(0, line->find('#')));
    if (text.empty()) continue;
    LineFields fields(path, lines.number(), text);
    edits.edits.push_back(read_edit(fields, lines.number()));
  }
  return edits;
}

void apply(const GraphEdits& edits, const std::vector<std::int64_t>& ids, PoseGraph& graph) {
  for (const GraphEdit& edit : edits.edits) apply_one({edits, edit, ids}, graph);
}

}  // namespace kissmap
