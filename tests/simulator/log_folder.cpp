// SPDX-License-Identifier: MIT
#include "simulator/log_folder.hpp"

#include <algorithm>
#include <bit>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "kissmap/error.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap::simulator {
namespace {

static_assert(std::endian::native == std::endian::little, "the PLY writer copies native floats");

std::string stamp_text(std::int64_t stamp_ns, char separator) {
  char text[40];
  std::snprintf(text,
                sizeof(text),
                "%" PRId64 "%c%09" PRId64,
                stamp_ns / 1'000'000'000,
                separator,
                stamp_ns % 1'000'000'000);
  return text;
}

template <typename Value>
void write_file(const std::filesystem::path& path,
                const std::string& header,
                const std::vector<Value>& body) {
  std::ofstream file(path, std::ios::binary);
  file << header;
  file.write(reinterpret_cast<const char*>(body.data()),
             static_cast<std::streamsize>(body.size() * sizeof(Value)));
  file.close();
  if (!file) throw output_error(path, "cannot be written; is the disk full?");
}

void write_ply(const Scan& scan, const std::filesystem::path& path) {
  std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                       std::to_string(scan.points.size()) + "\n";
  for (const char* property : {"x", "y", "z", "intensity", "time"}) {
    header += std::string("property float ") + property + "\n";
  }
  std::vector<float> body;
  body.reserve(5 * scan.points.size());
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3f& p = scan.points[i];
    body.insert(body.end(), {p.x(), p.y(), p.z(), scan.intensities[i], scan.time_offsets[i]});
  }
  write_file(path, header + "end_header\n", body);
}

std::string truth_line(const Simulator& simulator, std::size_t scan_idx) {
  const std::int64_t stamp = simulator.stamp_ns(scan_idx + 1);
  const Rigid3 map_from_lidar = simulator.map_from_lidar(stamp);
  const Eigen::Vector3d& t = map_from_lidar.translation;
  const Eigen::Quaterniond& q = map_from_lidar.rotation;
  char line[256];
  std::snprintf(line,
                sizeof(line),
                "%s %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n",
                stamp_text(stamp, '.').c_str(),
                t.x(),
                t.y(),
                t.z(),
                q.x(),
                q.y(),
                q.z(),
                q.w());
  return line;
}

std::string class_list() {
  std::string list = "number,name,moving\n";
  for (int k = 0; k < object_classes; ++k) {
    const auto object_class = static_cast<ObjectClass>(k);
    list += std::to_string(k) + "," + name(object_class) + (is_moving(object_class) ? ",1" : ",0");
    list += "\n";
  }
  return list;
}

void write_scans(const Simulator& simulator,
                 const std::filesystem::path& folder,
                 int threads,
                 bool labels,
                 std::size_t every,
                 const std::function<void(std::size_t done)>& progress) {
  ThreadPool pool(threads);
  const std::size_t batch = 8 * static_cast<std::size_t>(pool.size());
  const std::size_t count = (simulator.scan_count() + every - 1) / every;
  for (std::size_t begin = 0; begin < count; begin += batch) {
    const std::size_t end = std::min(begin + batch, count);
    pool.for_each_chunk(end - begin, [&](std::size_t k) {
      const LabelledScan labelled = simulator.labelled_scan(every * (begin + k));
      const std::string name = stamp_text(labelled.scan.stamp_ns, '_');
      write_ply(labelled.scan, folder / "scans" / (name + ".ply"));
      if (labels) write_file(folder / "labels" / (name + ".u8"), {}, labelled.classes);
    });
    progress(end);
  }
}

}  // namespace

void write_log_folder(const Simulator& simulator,
                      const std::filesystem::path& folder,
                      int threads,
                      const std::function<void(std::size_t done)>& progress,
                      bool labels,
                      std::size_t every) {
  if (std::filesystem::exists(folder)) {
    throw output_error(folder, "exists already; remove it or choose another folder");
  }
  const std::filesystem::path partial = folder.string() + ".partial";
  std::error_code failure;
  std::filesystem::remove_all(partial, failure);
  std::filesystem::create_directories(partial / "scans", failure);
  if (labels && !failure) std::filesystem::create_directory(partial / "labels", failure);
  if (failure) throw output_error(partial, "cannot be made: " + failure.message());
  write_scans(simulator, partial, threads, labels, every, progress);
  if (labels) write_file<char>(partial / "labels" / "classes.csv", class_list(), {});
  std::string truth;
  for (std::size_t i = 0; i < simulator.scan_count(); ++i) truth += truth_line(simulator, i);
  write_file<char>(partial / "truth.tum", truth, {});
  std::filesystem::rename(partial, folder, failure);
  if (failure) throw output_error(folder, "cannot be made: " + failure.message());
}

}  // namespace kissmap::simulator
