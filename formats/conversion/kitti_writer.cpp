// SPDX-License-Identifier: MIT
// The layout of the KITTI odometry data set (cvlibs.net/datasets/kitti).
#include <optional>

#include "formats/conversion/scan_folder.hpp"
#include "formats/conversion/scan_rows.hpp"
#include "formats/conversion/writers.hpp"
#include "formats/files/output_file.hpp"
#include "formats/trajectories/pose_lines.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

fs::path made(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) throw output_error(folder, "cannot be created: " + code.message());
  return folder;
}

class KittiWriter : public ScanWriter {
 public:
  explicit KittiWriter(const fs::path& path)
      : folder_(path),
        sequence_(made(folder_.path() / "sequences" / "00")),
        scans_(made(sequence_ / "velodyne")),
        times_(sequence_ / "times.txt") {
    std::string calibration;
    for (const char* name : {"P0", "P1", "P2", "P3", "Tr"}) {
      calibration += std::string(name) + ": 1 0 0 0 0 1 0 0 0 0 1 0\n";
    }
    write_whole_file(sequence_ / "calib.txt", calibration);
  }

  void add(const Scan& scan) override {
    OutputFile file(scans_ / (six_digits(count_++) + ".bin"));
    file.write(ScanRows{true, false}.bytes(scan));
    file.close();
    first_ = first_.value_or(scan.stamp_ns);
    times_.write(seconds_text(scan.stamp_ns - *first_) + "\n");
  }

  void finish() override {
    times_.close();
    folder_.publish();
  }

 private:
  AsideFolder folder_;
  fs::path sequence_;
  fs::path scans_;
  OutputFile times_;
  std::optional<std::int64_t> first_;
  std::uint64_t count_ = 0;
};

}  // namespace

std::unique_ptr<ScanWriter> open_kitti_writer(const fs::path& path) {
  return std::make_unique<KittiWriter>(path);
}

}  // namespace kissmap
