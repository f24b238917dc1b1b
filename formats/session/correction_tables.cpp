// SPDX-License-Identifier: MIT
#include "formats/session/correction_tables.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "formats/files/output_file.hpp"
#include "formats/files/row_text.hpp"
#include "formats/session/session_folder.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/g2o.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

/// Verdicts whose text is the reason.
constexpr std::array verdicts = {ClosureVerdict::accepted,
                                 ClosureVerdict::no_convergence,
                                 ClosureVerdict::low_overlap,
                                 ClosureVerdict::walls_disagree,
                                 ClosureVerdict::unobservable,
                                 ClosureVerdict::beyond_drift,
                                 ClosureVerdict::refused_by_graph,
                                 ClosureVerdict::removed_by_hand};
constexpr std::array sources = {
    ClosureSource::appearance, ClosureSource::trajectory, ClosureSource::hand};

std::string keyposes_header() {
  return "local_map_id," + pose_columns("map_from_local_map");
}

std::string poses_header() {
  return "log_index," + pose_columns("map_from_lidar");
}

std::string closures_header() {
  return "query_id,reference_id,query_stamp_ns,reference_stamp_ns,source,inliers,iterations,"
         "overlap,wall_agreement,residual_before,"
         "residual_after," +
         pose_columns("reference_from_query") +
         ",center_in_query_x,center_in_query_y,center_in_query_z,verdict,reason";
}

std::string neighbors_header() {
  return "reference_id,query_id," + pose_columns("reference_from_query") +
         ",reference_scan,query_scan,extent";
}

/// Of the upper triangle of an information matrix, row by row.
constexpr int information_columns = 21;

std::string surfaces_header() {
  std::string header = "reference_scan,query_scan," + pose_columns("reference_from_query");
  for (int i = 0; i < information_columns; ++i) header += ",information_" + std::to_string(i);
  return header;
}

std::string closure_row(const Closure& closure, const std::vector<std::int64_t>& stamps_ns) {
  const bool accepted = closure.verdict == ClosureVerdict::accepted;
  return RowText()
      .number(std::uint64_t{closure.query_id})
      .number(std::uint64_t{closure.reference_id})
      .number(stamps_ns.at(closure.query_id))
      .number(stamps_ns.at(closure.reference_id))
      .word(to_string(closure.source))
      .number(std::int64_t{closure.inliers})
      .number(std::int64_t{closure.iterations})
      .number(closure.overlap)
      .number(closure.wall_agreement)
      .number(closure.residual_before)
      .number(closure.residual_after)
      .pose(closure.reference_from_query)
      .number(closure.center_in_query.x())
      .number(closure.center_in_query.y())
      .number(closure.center_in_query.z())
      .word(accepted ? "accepted" : "refused")
      .word(reason(closure).c_str())
      .line();
}

template <typename Values>
auto named(std::string_view name, const Values& values, const TableReader& table) {
  for (const auto value : values) {
    if (name == to_string(value)) return value;
  }
  throw table.error("is none of the known words");
}

/// The inverse of reason().
void read_reason(TableReader& table, Closure& closure) {
  constexpr std::string_view fixed = "fixed by hand";
  std::string_view text = table.text();
  if (text == "added by hand") return;
  closure.trusted = text.starts_with(fixed);
  if (text == fixed) return;
  if (closure.trusted && text.substr(fixed.size()).starts_with("; ")) {
    text.remove_prefix(fixed.size() + 2);
  }
  closure.verdict = named(text, verdicts, table);
  const bool measured = closure.verdict != ClosureVerdict::refused_by_graph &&
                        closure.verdict != ClosureVerdict::removed_by_hand;
  if (measured) closure.first_verdict = closure.verdict;
  if (closure.trusted) closure.verdict = ClosureVerdict::accepted;
}

std::uint32_t read_id(TableReader& table, std::size_t local_maps) {
  const std::uint32_t id = table.unsigned_integer_32();
  if (id >= local_maps) throw table.error("is no local map of the session");
  return id;
}

Closure read_closure(TableReader& table, std::size_t local_maps) {
  Closure closure;
  closure.query_id = read_id(table, local_maps);
  closure.reference_id = read_id(table, local_maps);
  table.integer();
  table.integer();
  closure.source = named(table.text(), sources, table);
  closure.inliers = static_cast<int>(table.integer());
  closure.iterations = static_cast<int>(table.integer());
  closure.overlap = table.number();
  closure.wall_agreement = table.number();
  closure.residual_before = table.number();
  closure.residual_after = table.number();
  closure.reference_from_query = table.pose();
  for (double& coordinate : closure.center_in_query) coordinate = table.number();
  table.text();  // says no more than the reason
  read_reason(table, closure);
  table.end_row();
  return closure;
}

NeighborLink read_neighbor(TableReader& table, std::size_t local_maps) {
  NeighborLink link;
  link.reference_id = read_id(table, local_maps);
  if (read_id(table, local_maps) != link.reference_id + 1) {
    throw table.error("is not the local map after reference_id");
  }
  link.reference_from_query = table.pose();
  link.reference_scan = table.unsigned_integer_32();
  link.query_scan = table.unsigned_integer_32();
  link.extent = table.number();
  if (!(link.extent > 0.0)) throw table.error("extent is not above 0");
  table.end_row();
  return link;
}

SurfaceLink read_surface(TableReader& table, std::size_t scans) {
  SurfaceLink link;
  for (std::uint32_t* scan : {&link.reference_scan, &link.query_scan}) {
    *scan = table.unsigned_integer_32();
    if (*scan >= scans) throw table.error("is no scan of the session");
  }
  if (link.reference_scan >= link.query_scan) {
    throw table.error("is not later than reference_scan");
  }
  link.reference_from_query = table.pose();
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      link.information(row, column) = table.number();
      link.information(column, row) = link.information(row, column);
    }
  }
  table.end_row();
  return link;
}

void write_surfaces(const fs::path& session, const std::vector<SurfaceLink>& surfaces) {
  OutputFile file(session / surfaces_file_name);
  file.write(surfaces_header() + '\n');
  for (const SurfaceLink& link : surfaces) {
    RowText text;
    text.number(std::uint64_t{link.reference_scan})
        .number(std::uint64_t{link.query_scan})
        .pose(link.reference_from_query);
    for (int row = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column) text.number(link.information(row, column));
    }
    file.write(text.line());
  }
  file.close();
}

void write_keyposes(const fs::path& session, const std::vector<Rigid3>& map_from_local_map) {
  OutputFile file(session / keyposes_file_name);
  file.write(keyposes_header() + '\n');
  for (std::uint64_t id = 0; id < map_from_local_map.size(); ++id) {
    file.write(RowText().number(id).pose(map_from_local_map[id]).line());
  }
  file.close();
}

void write_poses(const fs::path& session,
                 const std::vector<std::uint64_t>& log_indices,
                 const std::vector<Rigid3>& map_from_lidar) {
  OutputFile file(session / poses_file_name);
  file.write(poses_header() + '\n');
  for (std::size_t i = 0; i < log_indices.size(); ++i) {
    file.write(RowText().number(log_indices[i]).pose(map_from_lidar[i]).line());
  }
  file.close();
}

void write_closures(const fs::path& session,
                    const std::vector<Closure>& closures,
                    const std::vector<std::int64_t>& stamps_ns) {
  OutputFile file(session / closures_file_name);
  file.write(closures_header() + '\n');
  for (const Closure& closure : closures) file.write(closure_row(closure, stamps_ns));
  file.close();
}

void write_neighbors(const fs::path& session, const std::vector<NeighborLink>& neighbors) {
  OutputFile file(session / neighbors_file_name);
  file.write(neighbors_header() + '\n');
  for (const NeighborLink& link : neighbors) {
    file.write(RowText()
                   .number(std::uint64_t{link.reference_id})
                   .number(std::uint64_t{link.reference_id} + 1)
                   .pose(link.reference_from_query)
                   .number(std::uint64_t{link.reference_scan})
                   .number(std::uint64_t{link.query_scan})
                   .number(link.extent)
                   .line());
  }
  file.close();
}

}  // namespace

void write_correction(const fs::path& session,
                      const LoopCorrection& correction,
                      const std::vector<std::uint64_t>& log_indices,
                      const std::vector<std::int64_t>& stamps_ns) {
  write_keyposes(session, correction.map_from_local_map);
  write_poses(session, log_indices, correction.map_from_lidar);
  write_closures(session, correction.closures, stamps_ns);
  write_neighbors(session, correction.neighbors);
  write_surfaces(session, correction.surfaces);
  GraphFile graph{correction.graph, {}, true, {}};
  graph.ids.resize(correction.map_from_local_map.size());
  std::iota(graph.ids.begin(), graph.ids.end(), std::int64_t{0});
  write_g2o(graph, session / graph_file_name, correction.edge_weights);
}

void correct_keyposes(const fs::path& session, std::vector<LocalMap>& local_maps) {
  if (!fs::exists(session / keyposes_file_name)) return;
  TableReader table(session / keyposes_file_name, keyposes_header(), damaged_session_cure);
  for (LocalMap& local_map : local_maps) {
    if (!table.next_row()) {
      throw input_error(
          session / keyposes_file_name,
          "has fewer rows than " + std::string(local_maps_file_name) + "; " + damaged_session_cure);
    }
    if (table.unsigned_integer_32() != local_map.id) {
      throw table.error("is not the number of the row, counted from 0");
    }
    local_map.map_from_local_map = table.pose();
    table.end_row();
  }
  if (table.next_row()) throw table.error("begins a row too many");
}

CorrectedPoses::CorrectedPoses(const fs::path& session)
    : path_(session / poses_file_name), table_(path_, poses_header(), damaged_session_cure) {
}

Rigid3 CorrectedPoses::next(std::uint64_t log_index) {
  if (!table_.next_row()) {
    throw input_error(
        path_, "has fewer rows than " + std::string(scans_file_name) + "; " + damaged_session_cure);
  }
  if (table_.unsigned_integer() != log_index) {
    throw table_.error("is not the log_index of the same row of " + std::string(scans_file_name));
  }
  Rigid3 pose = table_.pose();
  table_.end_row();
  return pose;
}

std::optional<CorrectedPoses> open_corrected_poses(const fs::path& session) {
  if (!fs::exists(session / poses_file_name)) return std::nullopt;
  return std::make_optional<CorrectedPoses>(session);
}

std::vector<Closure> read_closures(const fs::path& session, std::size_t local_maps) {
  if (!fs::exists(session / closures_file_name)) return {};
  TableReader table(session / closures_file_name, closures_header(), damaged_session_cure);
  std::vector<Closure> closures;
  while (table.next_row()) closures.push_back(read_closure(table, local_maps));
  return closures;
}

std::uint64_t count_measured(const std::vector<Closure>& closures) {
  return closures.size() - static_cast<std::uint64_t>(
                               std::ranges::count(closures, ClosureSource::hand, &Closure::source));
}

std::vector<NeighborLink> read_neighbors(const fs::path& session, std::size_t local_maps) {
  if (!fs::exists(session / neighbors_file_name)) return {};
  TableReader table(session / neighbors_file_name, neighbors_header(), damaged_session_cure);
  std::vector<NeighborLink> neighbors;
  while (table.next_row()) neighbors.push_back(read_neighbor(table, local_maps));
  return neighbors;
}

std::vector<SurfaceLink> read_surfaces(const fs::path& session, std::size_t scans) {
  if (!fs::exists(session / surfaces_file_name)) return {};
  TableReader table(session / surfaces_file_name, surfaces_header(), damaged_session_cure);
  std::vector<SurfaceLink> surfaces;
  while (table.next_row()) surfaces.push_back(read_surface(table, scans));
  return surfaces;
}

}  // namespace kissmap
