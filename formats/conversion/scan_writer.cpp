// SPDX-License-Identifier: MIT
#include "kissmap/formats/scan_writer.hpp"

#include "formats/conversion/writers.hpp"
#include "kissmap/error.hpp"

namespace kissmap {

ScanFormat scan_format_named(const std::string& name) {
  if (name == "pcd") return ScanFormat::pcd;
  if (name == "kitti") return ScanFormat::kitti;
  if (name == "mcap") return ScanFormat::mcap;
  throw usage_error("--to " + name + ": is none of pcd, kitti, mcap");
}

std::unique_ptr<ScanWriter> open_scan_writer(const std::filesystem::path& path, ScanFormat format) {
  switch (format) {
    case ScanFormat::pcd:
      return open_pcd_folder_writer(path);
    case ScanFormat::kitti:
      return open_kitti_writer(path);
    case ScanFormat::mcap:
      break;
  }
  return open_mcap_scan_writer(path);
}

}  // namespace kissmap
