// SPDX-License-Identifier: MIT
#include "formats/containers/sqlite_bag.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <utility>

#include "formats/clouds/refusal.hpp"
#include "formats/containers/bag_metadata.hpp"
#include "formats/containers/byte_cursor.hpp"
#include "formats/containers/container_file.hpp"
#include "formats/containers/ros_type.hpp"
#include "formats/containers/sqlite_database.hpp"
#include "formats/containers/unpack.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t zstd_magic = 0xFD2FB528;
constexpr std::uint64_t rows_that_tell = 1024;

/// True where the file is shorter than its header says.
bool is_cut(const ContainerFile& file) {
  std::vector<std::byte> buffer;
  const auto header = file.read(0, 100, buffer);
  if (header.size() < 100) return true;
  const auto at = [&](std::size_t i) { return std::to_integer<std::uint64_t>(header[i]); };
  const std::uint64_t page = (at(16) << 8U) + at(17);  // 1 stands for 65536
  const std::uint64_t pages = (at(28) << 24U) + (at(29) << 16U) + (at(30) << 8U) + at(31);
  return pages * (page == 1 ? 65536 : page) > file.size();
}

class SqliteSource : public MessageSource {
 public:
  SqliteSource(const fs::path& path, std::uint64_t most_bytes_to_count)
      : file_(path), database_(path) {
    try {
      cut_ = is_cut(file_);
      if (cut_) database_.accept_missing_pages();
      read_topics();
      if (most_bytes_to_count > 0 && !use_recorded_counts()) count_rows(most_bytes_to_count);
      read_time_range();
    } catch (const Refusal& refusal) {
      if (topic_of_.empty()) {
        throw input_error(path, std::string("no ROS 2 bag, or damaged: ") + refusal.what());
      }
      cut_ = true;
    }
  }

  const std::vector<Topic>& topics() const override { return topics_; }
  std::optional<std::pair<std::int64_t, std::int64_t>> time_range() const override {
    return time_range_;
  }
  std::optional<std::vector<std::int64_t>> times(std::size_t topic,
                                                 std::uint64_t most_bytes) override {
    try {
      if (cut_ || (!times_ && !read_times(most_bytes))) return std::nullopt;
    } catch (const Refusal&) {
      return std::nullopt;
    }
    std::vector<std::int64_t> times = (*times_)[topic];
    std::ranges::sort(times);
    return times;
  }
  void select(const std::set<std::size_t>& topics) override { selected_ = topics; }

  bool next(Message& message) override {
    if (!step("data")) return false;
    message.topic = topic_of_.at(rows_->integer(0));
    message.received_ns = rows_->integer(1);
    message.data = rows_->blob(2);
    passed_ = Place{message.received_ns, rows_->integer(3)};
    if (!is_packed(message.data)) return true;
    try {
      unpack_zstd_message(message.data, unpacked_);
    } catch (const Refusal& refusal) {
      damage_.push_back({refusal.reason(),
                         file_.path().string() + ": message " + std::to_string(rows_->integer(3)) +
                             ": " + refusal.what()});
    }
    message.data = unpacked_;
    return true;
  }

  // Where a query asks for the data, SQLite reads all of it at every step.
  std::uint64_t skip(std::uint64_t count) override {
    if (count == 0) return 0;
    std::uint64_t passed = 0;
    rows_.reset();
    while (passed < count && step("NULL")) {
      passed_ = Place{rows_->integer(1), rows_->integer(3)};
      ++passed;
    }
    rows_.reset();
    return passed;
  }

  const std::vector<ContainerDamage>& damage() const override { return damage_; }
  std::vector<LogFile> files() const override { return {file_.log_file()}; }
  std::vector<std::string> notes() const override { return notes_; }

 private:
  struct Place {
    std::int64_t timestamp = 0;
    std::int64_t id = 0;
  };

  void read_topics() {
    SqliteRows rows(database_, "SELECT id, name, type, serialization_format FROM topics");
    while (rows.step()) {
      // A page that is missing reads as empty.
      if (cut_ && rows.text(1).empty()) {
        throw Refusal(refusal_reason::truncated, "the file ends before the names of its topics");
      }
      const MessageEncoding encoding = rows.text(3) == "cdr" || rows.text(3).empty()
                                           ? MessageEncoding::cdr
                                           : MessageEncoding::other;
      topic_of_[rows.integer(0)] = topics_.size();
      topics_.push_back({rows.text(1), ros_type_name(rows.text(2)), encoding, std::nullopt});
    }
  }

  // By their ids, which a recorder gives one after the other.
  std::uint64_t row_count() {
    SqliteRows first(database_, "SELECT MIN(id) FROM messages");
    SqliteRows last(database_, "SELECT MAX(id) FROM messages");
    if (!first.step() || !last.step() || first.is_null(0)) return 0;
    const double rows =
        static_cast<double>(last.integer(0)) - static_cast<double>(first.integer(0));
    return static_cast<std::uint64_t>(std::clamp(rows + 1.0, 0.0, 1e12));
  }

  bool has_table(const std::string& name) {
    return SqliteRows(database_, "PRAGMA table_info(" + name + ")").step();
  }

  // A recorder that was killed, or went on in another file, left counts that do not add up.
  bool use_recorded_counts() {
    if (!has_table("metadata")) return false;
    SqliteRows rows(database_,
                    "SELECT metadata FROM metadata WHERE LENGTH(metadata) < 1000000 "
                    "ORDER BY id DESC LIMIT 1");
    if (!rows.step()) return false;
    std::map<std::string, std::uint64_t> counts;
    try {
      counts = recorded_counts(YAML::Load(rows.text(0)));
    } catch (const YAML::Exception&) {
      return false;
    }
    std::uint64_t sum = 0;
    for (const Topic& topic : topics_) sum += counts[topic.name];
    if (sum != row_count()) return false;
    for (Topic& topic : topics_) topic.message_count = counts[topic.name];
    return true;
  }

  void count_rows(std::uint64_t most_bytes) {
    if (!read_times(most_bytes)) return;
    for (std::size_t i = 0; i < topics_.size(); ++i) topics_[i].message_count = (*times_)[i].size();
  }

  // The topic of a message stands in its row alone, and a page holds one to some dozens: all have
  // to be looked at. False, soon, where that takes more than `most_bytes`.
  bool read_times(std::uint64_t most_bytes) {
    const std::uint64_t before = database_.bytes_read();
    const auto all = static_cast<double>(row_count());
    std::map<std::size_t, std::vector<std::int64_t>> times;
    SqliteRows rows(database_, "SELECT topic_id, timestamp FROM messages NOT INDEXED");
    for (std::uint64_t passed = 1; rows.step(); ++passed) {
      const auto topic = topic_of_.find(rows.integer(0));
      if (topic != topic_of_.end()) times[topic->second].push_back(rows.integer(1));
      const std::uint64_t bytes = database_.bytes_read() - before;
      const double in_all = static_cast<double>(bytes) * all / static_cast<double>(passed);
      const bool hopeless =
          passed % rows_that_tell == 0 && in_all > 2.0 * static_cast<double>(most_bytes);
      if (bytes > most_bytes || hopeless) return false;
    }
    times_ = std::move(times);
    return true;
  }

  // Each by itself is looked up in the index of times, both at once are not.
  void read_time_range() {
    SqliteRows first(database_, "SELECT MIN(timestamp) FROM messages");
    SqliteRows last(database_, "SELECT MAX(timestamp) FROM messages");
    if (first.step() && last.step() && !first.is_null(0)) {
      time_range_.emplace(first.integer(0), last.integer(0));
    }
  }

  bool has_time_index() {
    SqliteRows rows(database_, "PRAGMA index_list(messages)");
    return rows.step();
  }

  // Rows from the one after that passed last.
  void begin(const std::string& data) {
    std::string list;
    for (const auto& [id, topic] : topic_of_) {
      if (selected_.contains(topic)) list += (list.empty() ? "" : ",") + std::to_string(id);
    }
    // Of a cut file the index, which grows all along, is the first to be lost.
    const bool by_time = !cut_ && has_time_index();
    std::string after;
    if (passed_ && by_time) {
      const std::string time = std::to_string(passed_->timestamp);
      after = " AND timestamp >= " + time + " AND (timestamp > " + time + " OR id > " +
              std::to_string(passed_->id) + ")";
    } else if (passed_) {
      after = " AND id > " + std::to_string(passed_->id);
    }
    rows_ = std::make_unique<SqliteRows>(
        database_,
        "SELECT topic_id, timestamp, " + data + ", id FROM messages WHERE topic_id IN (" + list +
            ")" + after + " ORDER BY " + (by_time ? "timestamp, id" : "id"));
  }

  bool step(const char* data) {
    if (ended_) return false;
    try {
      if (!rows_) begin(data);
      if (rows_->step()) return true;
      if (cut_) throw Refusal(refusal_reason::truncated, "the file is shorter than it says");
    } catch (const Refusal& refusal) {
      damage_.push_back({cut_ ? refusal_reason::truncated : refusal.reason(),
                         file_.path().string() + ": " + refusal.what() +
                             "; messages before the damage are read"});
    }
    ended_ = true;
    return false;
  }

  static bool is_packed(std::span<const std::byte> data) {
    return data.size() > 4 && ByteCursor(data).value<std::uint32_t>() == zstd_magic;
  }

  ContainerFile file_;
  SqliteDatabase database_;
  std::unique_ptr<SqliteRows> rows_;
  std::optional<Place> passed_;
  std::map<std::int64_t, std::size_t> topic_of_;
  std::vector<Topic> topics_;
  std::set<std::size_t> selected_;
  std::optional<std::pair<std::int64_t, std::int64_t>> time_range_;
  std::optional<std::map<std::size_t, std::vector<std::int64_t>>> times_;  ///< by topic
  std::vector<std::byte> unpacked_;
  std::vector<ContainerDamage> damage_;
  std::vector<std::string> notes_;
  bool cut_ = false;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<MessageSource> open_sqlite_bag(const fs::path& path,
                                               std::uint64_t most_bytes_to_count) {
  return std::make_unique<SqliteSource>(path, most_bytes_to_count);
}

}  // namespace kissmap
