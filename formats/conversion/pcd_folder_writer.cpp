// SPDX-License-Identifier: MIT
// PCD v0.7 (pointclouds.org).
#include "formats/conversion/scan_folder.hpp"
#include "formats/conversion/scan_rows.hpp"
#include "formats/conversion/writers.hpp"
#include "formats/files/output_file.hpp"
#include "formats/trajectories/pose_lines.hpp"

namespace kissmap {
namespace {

std::string header(const ScanRows& rows, std::size_t points) {
  std::string names = "x y z";
  if (rows.with_intensity) names += " intensity";
  if (rows.with_time) names += " time";
  const auto repeated = [&](const char* word) {
    std::string words;
    for (std::size_t i = 0; i < rows.columns(); ++i) words += std::string(" ") + word;
    return words;
  };
  const std::string count = std::to_string(points);
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + names + "\nSIZE" +
         repeated("4") + "\nTYPE" + repeated("F") + "\nCOUNT" + repeated("1") + "\nWIDTH " + count +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
}

class PcdFolderWriter : public ScanWriter {
 public:
  explicit PcdFolderWriter(const std::filesystem::path& path)
      : folder_(path), times_(folder_.path() / "times.txt") {}

  void add(const Scan& scan) override {
    const ScanRows rows{!scan.intensities.empty(), !scan.time_offsets.empty()};
    OutputFile file(folder_.path() / (six_digits(count_++) + ".pcd"));
    file.write(header(rows, scan.points.size()));
    file.write(rows.bytes(scan));
    file.close();
    times_.write(seconds_text(scan.stamp_ns) + "\n");
  }

  void finish() override {
    times_.close();
    folder_.publish();
  }

 private:
  AsideFolder folder_;
  OutputFile times_;
  std::uint64_t count_ = 0;
};

}  // namespace

std::unique_ptr<ScanWriter> open_pcd_folder_writer(const std::filesystem::path& path) {
  return std::make_unique<PcdFolderWriter>(path);
}

}  // namespace kissmap
