// SPDX-License-Identifier: MIT
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/files/input_file.hpp"
#include "formats/graphs/g2o_units.hpp"
#include "formats/graphs/line_fields.hpp"
#include "formats/text/lines.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/g2o.hpp"

namespace kissmap {
namespace {

/// What a line says before ids are known to be nodes.
struct FileVertex {
  std::int64_t id = 0;
  std::size_t line = 0;
  Rigid3 pose;
};
struct FileEdge {
  std::int64_t from = 0;
  std::int64_t to = 0;
  std::size_t line = 0;
  PoseGraphEdge edge;
};
struct FileFix {
  std::int64_t id = 0;
  std::size_t line = 0;
};

class Reader {
 public:
  Reader(const std::filesystem::path& path, NegativeInformation negative)
      : path_(path), negative_(negative) {}

  GraphFile read() {
    const std::vector<std::byte> bytes = read_side_file(path_);
    Lines lines(text_of(bytes));
    while (const auto line = lines.next()) {
      LineFields fields(path_, lines.number(), *line);
      take(fields, lines.number());
    }
    return assemble();
  }

 private:
  void take(LineFields& fields, std::size_t line) {
    const std::string_view tag = fields.word();
    if (tag.empty() || tag.front() == '#') return;
    if (tag == "VERTEX_SE3:QUAT" || tag == "VERTEX_SE2") {
      require_space(tag == "VERTEX_SE2", fields);
      take_vertex(fields, line);
    } else if (tag == "EDGE_SE3:QUAT" || tag == "EDGE_SE2") {
      require_space(tag == "EDGE_SE2", fields);
      take_edge(fields, line);
    } else if (tag == "FIX") {
      do fixes_.push_back({fields.id("id"), line});
      while (!fields.at_end());
    } else {
      skip(tag);
    }
  }

  void skip(std::string_view tag) {
    constexpr std::size_t max_tags = 100;  // a file that is no graph has as many as words
    constexpr std::size_t max_length = 40;
    const std::string name(tag.substr(0, max_length));
    if (file_.skipped.size() >= max_tags && !file_.skipped.contains(name)) {
      ++file_.skipped["others"];
    } else {
      ++file_.skipped[name];
    }
  }

  void require_space(bool planar, const LineFields& fields) {
    const bool first = vertices_.empty() && edges_.empty();
    if (first) file_.graph.space = planar ? GraphSpace::planar : GraphSpace::spatial;
    if (planar == (file_.graph.space == GraphSpace::planar)) return;
    throw fields.error("SE2 and SE3 lines in one file; a graph is either planar or spatial");
  }

  bool planar() const { return file_.graph.space == GraphSpace::planar; }

  void take_vertex(LineFields& fields, std::size_t line) {
    FileVertex vertex;
    vertex.line = line;
    vertex.id = fields.id("id");
    vertex.pose = planar() ? fields.planar_pose() : fields.pose();
    fields.end();
    vertices_.push_back(vertex);
  }

  void take_edge(LineFields& fields, std::size_t line) {
    FileEdge edge;
    edge.line = line;
    edge.from = fields.id("first id");
    edge.to = fields.id("second id");
    if (edge.from == edge.to) throw fields.error("an edge from a vertex to itself");
    edge.edge.from_from_to = planar() ? fields.planar_pose() : fields.pose();
    edge.edge.information = planar() ? planar_information(fields) : spatial_information(fields);
    edge.edge.kind = kind_between(edge.from, edge.to);
    fields.end();
    edges_.push_back(edge);
  }

  Information spatial_information(LineFields& fields) {
    Information information;
    for (int row = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column) {
        information(row, column) = fields.number("information");
        information(column, row) = information(row, column);
      }
    }
    make_positive(information, fields);
    return information_from_g2o(information);
  }

  // What the plane does not have gets unit information: its errors are zero and stay so.
  Information planar_information(LineFields& fields) {
    Information information = Information::Identity();
    for (int row = 0; row < 3; ++row) {
      for (int column = row; column < 3; ++column) {
        const double value = fields.number("information");
        information(planar_rows[row], planar_rows[column]) = value;
        information(planar_rows[column], planar_rows[row]) = value;
      }
    }
    make_positive(information, fields);
    return information;
  }

  static bool is_positive(const Information& information) {
    constexpr double rounding = 1e-9;
    const double size = information.cwiseAbs().maxCoeff();
    const Eigen::SelfAdjointEigenSolver<Information> eigen(information, Eigen::EigenvaluesOnly);
    return eigen.info() == Eigen::Success && eigen.eigenvalues().minCoeff() >= -rounding * size;
  }

  void make_positive(Information& information, const LineFields& fields) {
    if (is_positive(information)) return;
    if (negative_ == NegativeInformation::drop_coupling) {
      information.topRightCorner<3, 3>().setZero();
      information.bottomLeftCorner<3, 3>().setZero();
      ++file_.couplings_dropped;
      if (is_positive(information)) return;
    }
    throw fields.error(
        "the information is negative in some direction; kissmap optimize --drop-coupling keeps its "
        "translation and rotation blocks if they are not");
  }

  Error error_at(std::size_t line, const std::string& message) const {
    return LineFields(path_, line, "").error(message);
  }

  void name_nodes() {
    for (const FileVertex& vertex : vertices_) file_.ids.push_back(vertex.id);
    if (vertices_.empty()) {
      for (const FileEdge& edge : edges_) file_.ids.insert(file_.ids.end(), {edge.from, edge.to});
    }
    std::ranges::sort(file_.ids);
    file_.ids.erase(std::unique(file_.ids.begin(), file_.ids.end()), file_.ids.end());
    if (file_.ids.empty()) {
      throw input_error(path_, "holds no vertex and no edge of a pose graph (SE2 or SE3:QUAT)");
    }
  }

  std::uint32_t node(std::int64_t id, std::size_t line) const {
    const auto index = node_of(file_, id);
    if (!index) throw error_at(line, "there is no vertex " + std::to_string(id));
    return *index;
  }

  void place_vertices() {
    file_.has_start = !vertices_.empty();
    file_.graph.map_from_node.resize(file_.ids.size());
    std::vector<bool> placed(file_.ids.size(), false);
    for (const FileVertex& vertex : vertices_) {
      const std::uint32_t index = node(vertex.id, vertex.line);
      if (placed[index]) {
        throw error_at(vertex.line, "vertex " + std::to_string(vertex.id) + " is there twice");
      }
      placed[index] = true;
      file_.graph.map_from_node[index] = vertex.pose;
    }
  }

  GraphFile assemble() {
    name_nodes();
    place_vertices();
    for (FileEdge& edge : edges_) {
      edge.edge.from = node(edge.from, edge.line);
      edge.edge.to = node(edge.to, edge.line);
      file_.graph.edges.push_back(edge.edge);
    }
    std::vector<std::uint32_t> fixed;
    for (const FileFix& fix : fixes_) fixed.push_back(node(fix.id, fix.line));
    if (!fixed.empty()) file_.graph.fixed = fixed;
    return std::move(file_);
  }

  const std::filesystem::path& path_;
  NegativeInformation negative_;
  GraphFile file_;
  std::vector<FileVertex> vertices_;
  std::vector<FileEdge> edges_;
  std::vector<FileFix> fixes_;
};

}  // namespace

std::optional<std::uint32_t> node_of(const GraphFile& file, std::int64_t id) {
  const auto place = std::ranges::lower_bound(file.ids, id);
  if (place == file.ids.end() || *place != id) return std::nullopt;
  return static_cast<std::uint32_t>(place - file.ids.begin());
}

GraphFile read_g2o(const std::filesystem::path& path, NegativeInformation negative) {
  return Reader(path, negative).read();
}

}  // namespace kissmap
