// SPDX-License-Identifier: MIT
// NCLT's raw stream, velodyne_hits.bin: packets of a mark, the number of hits, the time in us and
// hits of 8 bytes as in velodyne_sync, in the frame of the Velodyne, whose z points down as well.
// Layout: the data set's read_vel_hits.py.
#include <cmath>
#include <cstring>
#include <deque>
#include <numbers>
#include <utility>

#include "formats/clouds/refusal.hpp"
#include "formats/containers/container_file.hpp"
#include "formats/datasets/dataset_folder.hpp"
#include "formats/datasets/datasets.hpp"
#include "formats/sensors/sweep_builder.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/trajectory_file.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t head_bytes = 24;
constexpr std::size_t hit_bytes = 8;
constexpr std::uint32_t most_hits = 20'000;  // a packet of the sensor has 384
constexpr std::uint64_t window_bytes = 1 << 20;
constexpr std::uint64_t latest_us = 4'000'000'000'000'000;  // later is damage
constexpr float step = 0.005F;                              // m
constexpr float lowest = 100.0F;                            // m below zero

bool is_mark(std::span<const std::byte> bytes) {
  std::uint16_t marks[4];
  std::memcpy(marks, bytes.data(), sizeof(marks));
  return marks[0] == 44444 && marks[1] == 44444 && marks[2] == 44444 && marks[3] == 44444;
}

template <class T>
T at(std::span<const std::byte> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.subspan(offset, sizeof(T)).data(), sizeof(T));
  return value;
}

class HitsLog : public ScanLog {
 public:
  explicit HitsLog(const fs::path& path) : file_(path), builder_(sweeps_) {
    info_.format = "nclt-hits";
    info_.path = path;
    info_.sensor = "Velodyne HDL-32E";
    info_.stamp_source = "packets";
    info_.fields = "x f32, y f32, z f32, intensity f32, time f32";
    info_.notes = {"sweeps by azimuth, a point has the time of its packet, turned to z up",
                   mount_note("the body, whose poses are the truth", mount_from("nclt-hits"))};
    info_.time_range = time_range();
  }

  const LogInfo& info() const override { return info_; }
  std::vector<LogFile> files() const override { return {file_.log_file()}; }

  std::optional<LogEntry> next() override {
    while (sweeps_.empty() && !at_end_) read_packet();
    if (!sweeps_.empty()) {
      const std::string name = "sweep " + std::to_string(next_index_);
      LogEntry entry{next_index_++, name, std::move(sweeps_.front())};
      sweeps_.pop_front();
      return entry;
    }
    if (lost_bytes_ == 0) return std::nullopt;
    const std::string detail = info_.path.string() + ": " + std::to_string(lost_bytes_) +
                               " bytes belong to no whole packet; is the file cut?";
    lost_bytes_ = 0;
    return LogEntry{next_index_++,
                    info_.path.filename().string(),
                    RefusedScan{refusal_reason::broken_content, detail}};
  }

 private:
  // By the first packet, and the last one of those that follow each other to the end of the file.
  std::optional<std::pair<std::int64_t, std::int64_t>> time_range() {
    std::vector<std::byte> first_bytes;
    const auto first = file_.read(0, head_bytes, first_bytes);
    if (first.size() < head_bytes || !is_mark(first)) return std::nullopt;
    const std::uint64_t begin = file_.size() > window_bytes ? file_.size() - window_bytes : 0;
    const auto tail = file_.read(begin, window_bytes, buffer_);
    std::uint64_t last_us = 0;
    for (std::size_t i = 0; i + head_bytes <= tail.size();) {
      const auto packet = tail.subspan(i);
      const bool whole = is_mark(packet) && at<std::uint32_t>(packet, 8) <= most_hits;
      if (whole) last_us = at<std::uint64_t>(packet, 12);
      i += whole ? head_bytes + std::size_t{at<std::uint32_t>(packet, 8)} * hit_bytes : 1;
    }
    const auto first_us = at<std::uint64_t>(first, 12);
    if (last_us <= first_us || last_us > latest_us) return std::nullopt;
    return std::pair(static_cast<std::int64_t>(first_us) * 1000,
                     static_cast<std::int64_t>(last_us) * 1000);
  }

  void finish() {
    at_end_ = true;
    lost_bytes_ += file_.size() - std::min(file_.size(), offset_);
    builder_.finish();
  }

  void read_packet() {
    const auto head = file_.read(offset_, head_bytes, buffer_);
    if (head.size() < head_bytes) return finish();
    const auto hits = at<std::uint32_t>(head, 8);
    const auto time_us = at<std::uint64_t>(head, 12);
    if (!is_mark(head) || hits > most_hits || time_us > latest_us) return find_mark();
    const auto time_ns = static_cast<std::int64_t>(time_us) * 1000;
    const std::uint64_t size = std::uint64_t{hits} * hit_bytes;
    const auto body = file_.read(offset_ + head_bytes, size, buffer_);
    if (body.size() < size) return finish();
    add_packet(body, time_ns);
    offset_ += head_bytes + size;
  }

  // Damage: on to the next packet.
  void find_mark() {
    const std::uint64_t begin = offset_;
    while (true) {
      const auto window = file_.read(offset_ + 1, window_bytes, buffer_);
      if (window.size() < 8) break;
      for (std::size_t i = 0; i + 8 <= window.size(); ++i) {
        if (!is_mark(window.subspan(i, 8))) continue;
        offset_ += 1 + i;
        lost_bytes_ += offset_ - begin;
        return;
      }
      offset_ += window.size() - 7;
    }
    offset_ = begin;
    finish();
  }

  void add_packet(std::span<const std::byte> hits, std::int64_t time_ns) {
    bool begun = false;
    for (std::size_t i = 0; i < hits.size(); i += hit_bytes) {
      const auto raw = [&](std::size_t k) {
        return static_cast<float>(at<std::uint16_t>(hits, i + 2 * k)) * step - lowest;
      };
      const Eigen::Vector3f point(raw(0), -raw(1), -raw(2));
      if (!(point.head<2>().norm() > 0.1F)) continue;
      // Seen from above the sensor turns clockwise.
      const double azimuth = -std::atan2(point.y(), point.x()) * 180.0 / std::numbers::pi;
      if (!std::exchange(begun, true)) {
        const double from_ahead = std::fmod(azimuth + 720.0, 360.0);
        builder_.begin_column(from_ahead, time_ns, time_ns, hits.size() / hit_bytes);
      }
      builder_.add(point, static_cast<float>(at<std::uint8_t>(hits, i + 6)), time_ns);
    }
  }

  ContainerFile file_;
  LogInfo info_;
  std::deque<Scan> sweeps_;
  SweepBuilder builder_;
  std::vector<std::byte> buffer_;
  std::uint64_t offset_ = 0;
  std::uint64_t lost_bytes_ = 0;
  std::size_t next_index_ = 0;
  bool at_end_ = false;
};

}  // namespace

bool probe_nclt_hits(const fs::path& path) {
  std::error_code error;
  return path.filename() == "velodyne_hits.bin" && fs::is_regular_file(path, error);
}

std::unique_ptr<ScanLog> open_nclt_hits(const fs::path& path, const ReadOptions& options) {
  require_valid(options);
  return std::make_unique<HitsLog>(path);
}

}  // namespace kissmap
