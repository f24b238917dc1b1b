// SPDX-License-Identifier: MIT
#include "formats/session/session_tables.hpp"

#include <algorithm>
#include <optional>

#include "formats/files/row_text.hpp"
#include "formats/files/table.hpp"
#include "formats/session/correction_tables.hpp"
#include "formats/session/session_folder.hpp"

namespace kissmap {
namespace {

SessionScan read_scan(TableReader& table) {
  SessionScan scan;
  MappedScan& mapped = scan.mapped;
  scan.log_index = table.unsigned_integer();
  mapped.stamp_ns = table.integer();
  mapped.pose_stamp_ns = table.integer();
  mapped.local_map_id = table.unsigned_integer_32();
  mapped.local_map_from_lidar = table.pose();
  mapped.deskewed = table.flag();
  mapped.sweep_start_from_sweep_end = table.pose();
  mapped.points_read = table.unsigned_integer();
  mapped.points_in_range = table.unsigned_integer();
  mapped.iterations = table.unsigned_integer_32();
  mapped.converged = table.flag();
  table.end_row();
  return scan;
}

LocalMapEnd read_end(TableReader& table) {
  const std::string_view end = table.text();
  if (end == "split") return LocalMapEnd::split;
  if (end == "end_of_log") return LocalMapEnd::end_of_log;
  throw table.error("is neither split nor end_of_log");
}

LocalMap read_local_map(TableReader& table, std::size_t expected_id) {
  LocalMap map;
  map.id = table.unsigned_integer_32();
  if (map.id != expected_id) throw table.error("is not the number of the row, counted from 0");
  map.map_from_local_map = table.pose();
  map.scan_count = table.unsigned_integer();
  map.path_length = table.number();
  map.displacement = table.number();
  map.end = read_end(table);
  table.end_row();
  return map;
}

}  // namespace

std::string scans_header() {
  return "log_index,stamp_ns,pose_stamp_ns,local_map_id," + pose_columns("local_map_from_lidar") +
         ",deskewed," + pose_columns("sweep_start_from_sweep_end") +
         ",points_read,points_in_range,iterations,converged";
}

std::string local_maps_header() {
  return "local_map_id," + pose_columns("map_from_local_map") +
         ",scan_count,path_length,displacement,end";
}

std::string scan_row(const SessionScan& scan) {
  const MappedScan& mapped = scan.mapped;
  return RowText()
      .number(scan.log_index)
      .number(mapped.stamp_ns)
      .number(mapped.pose_stamp_ns)
      .number(std::uint64_t{mapped.local_map_id})
      .pose(mapped.local_map_from_lidar)
      .flag(mapped.deskewed)
      .pose(mapped.sweep_start_from_sweep_end)
      .number(mapped.points_read)
      .number(mapped.points_in_range)
      .number(std::uint64_t{mapped.iterations})
      .flag(mapped.converged)
      .line();
}

std::string local_map_row(const LocalMap& local_map) {
  return RowText()
      .number(std::uint64_t{local_map.id})
      .pose(local_map.map_from_local_map)
      .number(local_map.scan_count)
      .number(local_map.path_length)
      .number(local_map.displacement)
      .word(local_map.end == LocalMapEnd::split ? "split" : "end_of_log")
      .line();
}

void note_first_stamp(const MappedScan& scan, std::vector<std::int64_t>& stamps_ns) {
  const std::size_t id = scan.local_map_id;
  stamps_ns.resize(std::max(stamps_ns.size(), id + 1), scan.pose_stamp_ns);
}

std::vector<LocalMap> read_odometry_local_maps(const std::filesystem::path& session) {
  TableReader table(session / local_maps_file_name, local_maps_header(), damaged_session_cure);
  std::vector<LocalMap> maps;
  while (table.next_row()) maps.push_back(read_local_map(table, maps.size()));
  return maps;
}

std::vector<LocalMap> read_local_maps(const std::filesystem::path& session) {
  std::vector<LocalMap> maps = read_odometry_local_maps(session);
  correct_keyposes(session, maps);
  return maps;
}

void for_each_scan(const std::filesystem::path& session,
                   const std::vector<LocalMap>& local_maps,
                   UnclosedScans unclosed,
                   const std::function<void(const SessionScan&)>& visit) {
  TableReader table(session / scans_file_name, scans_header(), damaged_session_cure);
  std::optional<CorrectedPoses> corrected = open_corrected_poses(session);
  std::optional<std::uint64_t> last_index;
  while (table.next_row()) {
    SessionScan scan = read_scan(table);
    MappedScan& mapped = scan.mapped;
    if (last_index && scan.log_index <= *last_index) {
      throw table.error("ends a scan whose log_index is not above that of the scan before");
    }
    last_index = scan.log_index;
    const std::optional<Rigid3> pose =
        corrected ? std::optional(corrected->next(scan.log_index)) : std::nullopt;
    if (mapped.local_map_id >= local_maps.size()) {
      if (unclosed == UnclosedScans::pass_over) continue;
      throw table.error("ends a scan whose local_map_id is not in " +
                        std::string(local_maps_file_name));
    }
    mapped.map_from_lidar =
        pose ? *pose
             : local_maps[mapped.local_map_id].map_from_local_map * mapped.local_map_from_lidar;
    visit(scan);
  }
}

}  // namespace kissmap
