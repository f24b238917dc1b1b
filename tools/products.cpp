// SPDX-License-Identifier: MIT
#include <cstdio>

#include "commands.hpp"
#include "export_options.hpp"
#include "kissmap/formats/product_folder.hpp"
#include "kissmap/parallel/task_thread.hpp"
#include "progress.hpp"
#include "report.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

/// Makes the default products one after the other and describes them, a line each.
class ProductWriter {
 public:
  ProductWriter(const ProductsCommand& command, ProgressLine& line)
      : command_(command), session_(read_session(command.session)), pool_(command.threads) {
    show_ = [&line](const char* what, std::uint64_t done, std::uint64_t of) {
      line.show(text("%s: %s/%s", what, with_commas(done).c_str(), with_commas(of).c_str()));
    };
  }

  /// The cloud, whose points are thinned by one thread, beside the others.
  std::string write_all(const fs::path& folder) {
    std::string cloud;
    TaskThread beside(1);
    beside.add([&] { cloud = write_cloud(folder); });
    const std::string others = write_voxels(folder) + write_grid(folder);
    beside.finish();
    return cloud + others;
  }

 private:
  std::string write_cloud(const fs::path& folder) {
    ExportCloudCommand cloud;
    cloud.log = command_.log;
    ThreadPool alone(1);
    const auto silent = [](const char*, std::uint64_t, std::uint64_t) {};
    const CloudExportSummary summary = export_cloud(
        session_, folder / cloud_product_name, cloud_options(cloud, session_), alone, silent);
    return text(
        "    %-16s%s points\n", cloud_product_name, with_commas(summary.points_written).c_str());
  }

  std::string write_voxels(const fs::path& folder) {
    ExportVoxelsCommand voxels;
    voxels.log = command_.log;
    const VoxelExportSummary summary = export_voxels(
        session_, folder / voxels_product_name, voxel_options(voxels, session_), pool_, show_);
    return text("    %-16s%s\n", voxels_product_name, describe(summary).c_str());
  }

  std::string write_grid(const fs::path& folder) {
    ExportGridCommand grid;
    grid.log = command_.log;
    const GridExportSummary summary = export_grid(
        session_, folder / grid_product_stem, grid_options(grid, session_), pool_, show_);
    std::string lines;
    for (const ExportedGrid& level : summary.levels) {
      lines += text("    %-16s%s\n", level.yaml.filename().c_str(), describe(level).c_str());
    }
    return lines;
  }

  const ProductsCommand& command_;
  Session session_;
  ThreadPool pool_;
  ExportProgress show_;
};

}  // namespace

void write_products(const ProductsCommand& command) {
  std::string lines;
  fs::path written;
  double seconds = 0.0;
  {
    ProgressLine line(!command.quiet);
    ProductWriter writer(command, line);
    ProductFolder folder(command.session);
    lines = writer.write_all(folder.path());
    written = folder.publish();
    seconds = line.seconds();
  }
  if (command.quiet) return;
  std::printf(
      "  products    %s, %.1f s\n%s", printable(written.string()).c_str(), seconds, lines.c_str());
}

}  // namespace kissmap
