// SPDX-License-Identifier: MIT
#include "formats/products/removed_cloud.hpp"

#include "kissmap/formats/session_replay.hpp"

namespace kissmap {

std::unique_ptr<MovedReturns> find_moved(const Session& session,
                                         const CloudExportOptions& options,
                                         ThreadPool& pool,
                                         const ExportProgress& progress) {
  auto moved = std::make_unique<MovedReturns>();
  for (const bool has_returns : {false, true}) {
    SessionReplay replay(session, options.min_range, options.max_range, options.moved_log);
    while (const std::optional<PlacedScan> scan = replay.next()) {
      if (has_returns) {
        moved->add_rays(*scan, pool);
      } else {
        moved->add_returns(*scan);
      }
      progress(has_returns ? "looking for what moved" : "gathering returns",
               scan->scan_idx + 1,
               replay.size());
    }
  }
  moved->decide(pool);
  return moved;
}

std::filesystem::path removed_path(const std::filesystem::path& output) {
  const bool is_file = cloud_format(output).has_value();
  std::filesystem::path path = output;
  path.replace_filename((is_file ? output.stem() : output.filename()).string() + "_removed" +
                        (is_file ? output.extension().string() : ".pcd"));
  return path;
}

}  // namespace kissmap
