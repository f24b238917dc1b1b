// SPDX-License-Identifier: MIT
#include "formats/containers/sqlite_bag.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <utility>

#include "formats/clouds/refusal.hpp"
#include "formats/containers/byte_cursor.hpp"
#include "formats/containers/container_file.hpp"
#include "formats/containers/ros_type.hpp"
#include "formats/containers/unpack.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

// The topic of a message stands in its row, and a row of any size has a page of its own.
constexpr std::uint64_t page_bytes = 4096;
constexpr std::uint64_t most_bytes_to_count = 32 << 20;
constexpr std::uint32_t zstd_magic = 0xFD2FB528;

// A path within a URI: what has a meaning there is written as %XX.
std::string uri_of(const fs::path& path, const char* mode) {
  constexpr const char* digits = "0123456789ABCDEF";
  std::string uri = "file:";
  for (const char c : path.string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || c == '/' || c == '.' || c == '_' || c == '-') {
      uri += c;
    } else {
      uri += {'%', digits[byte >> 4U], digits[byte & 15U]};
    }
  }
  return uri + mode;
}

class Statement {
 public:
  Statement(sqlite3* database, const std::string& query) {
    if (sqlite3_prepare_v2(database, query.c_str(), -1, &statement_, nullptr) != SQLITE_OK) {
      throw Refusal(refusal_reason::broken_content, sqlite3_errmsg(database));
    }
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  /// True for a row, false at the end. Throws Refusal for a damaged file.
  bool step() {
    const int result = sqlite3_step(statement_);
    if (result == SQLITE_ROW) return true;
    if (result == SQLITE_DONE) return false;
    throw Refusal(refusal_reason::broken_content, sqlite3_errmsg(sqlite3_db_handle(statement_)));
  }
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  std::string text(int column) const {
    const auto* chars = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return chars == nullptr ? "" : chars;
  }
  std::span<const std::byte> blob(int column) const {
    const auto* bytes = static_cast<const std::byte*>(sqlite3_column_blob(statement_, column));
    return {bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
  }
  bool is_null(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }

 private:
  sqlite3_stmt* statement_ = nullptr;
};

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
  SqliteSource(const fs::path& path, bool count) : file_(path) {
    open();
    try {
      cut_ = is_cut(file_);
      if (cut_) accept_missing_pages();
      read_topics();
      if (count && rows_to_look_at() * page_bytes <= most_bytes_to_count) count_messages();
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
    if (cut_ || rows_to_look_at() * page_bytes > most_bytes) return std::nullopt;
    std::vector<std::int64_t> times;
    try {
      Statement rows(database_.get(),
                     "SELECT topic_id, timestamp FROM messages ORDER BY timestamp");
      while (rows.step()) {
        const auto of = topic_of_.find(rows.integer(0));
        if (of != topic_of_.end() && of->second == topic) times.push_back(rows.integer(1));
      }
    } catch (const Refusal&) {
      return std::nullopt;
    }
    return times;
  }
  void select(const std::set<std::size_t>& topics) override { selected_ = topics; }

  bool next(Message& message) override {
    if (!step()) return false;
    message.topic = topic_of_.at(rows_->integer(0));
    message.received_ns = rows_->integer(1);
    message.data = rows_->blob(2);
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

  std::uint64_t skip(std::uint64_t count) override {
    std::uint64_t passed = 0;
    while (passed < count && step()) ++passed;
    return passed;
  }

  const std::vector<ContainerDamage>& damage() const override { return damage_; }
  std::vector<LogFile> files() const override { return {file_.log_file()}; }
  std::vector<std::string> notes() const override { return notes_; }

 private:
  void open() {
    // A log of changes beside the file belongs to it; without one nothing is written anywhere.
    std::error_code no_file;
    const fs::path changes = file_.path().string() + "-wal";
    const bool has_changes = fs::exists(changes, no_file) && fs::file_size(changes, no_file) > 0;
    const std::string uri = uri_of(file_.path(), has_changes ? "?mode=ro" : "?mode=ro&immutable=1");
    sqlite3* raw = nullptr;
    const int result =
        sqlite3_open_v2(uri.c_str(), &raw, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(raw);
    if (result != SQLITE_OK) {
      throw input_error(file_.path(),
                        std::string("cannot be opened: ") + sqlite3_errmsg(raw) +
                            (has_changes ? "; its -wal file wants a folder that can be written, "
                                           "copy both to one"
                                         : ""));
    }
  }

  // Otherwise SQLite reads nothing of a file that is shorter than its header says.
  void accept_missing_pages() { Statement(database_.get(), "PRAGMA writable_schema=ON").step(); }

  void read_topics() {
    Statement rows(database_.get(), "SELECT id, name, type, serialization_format FROM topics");
    while (rows.step()) {
      const MessageEncoding encoding = rows.text(3) == "cdr" || rows.text(3).empty()
                                           ? MessageEncoding::cdr
                                           : MessageEncoding::other;
      topic_of_[rows.integer(0)] = topics_.size();
      topics_.push_back({rows.text(1), ros_type_name(rows.text(2)), encoding, std::nullopt});
    }
  }

  std::uint64_t rows_to_look_at() {
    Statement first(database_.get(), "SELECT MIN(id) FROM messages");
    Statement last(database_.get(), "SELECT MAX(id) FROM messages");
    if (!first.step() || !last.step() || first.is_null(0)) return 0;
    const double rows =
        static_cast<double>(last.integer(0)) - static_cast<double>(first.integer(0));
    return static_cast<std::uint64_t>(std::clamp(rows + 1.0, 0.0, 1e12));
  }

  void count_messages() {
    std::map<std::size_t, std::uint64_t> counts;
    Statement rows(database_.get(), "SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id");
    while (rows.step()) {
      const auto topic = topic_of_.find(rows.integer(0));
      if (topic != topic_of_.end()) {
        counts[topic->second] = static_cast<std::uint64_t>(rows.integer(1));
      }
    }
    for (std::size_t i = 0; i < topics_.size(); ++i) topics_[i].message_count = counts[i];
  }

  // Each by itself is looked up in the index of times, both at once are not.
  void read_time_range() {
    Statement first(database_.get(), "SELECT MIN(timestamp) FROM messages");
    Statement last(database_.get(), "SELECT MAX(timestamp) FROM messages");
    if (first.step() && last.step() && !first.is_null(0)) {
      time_range_.emplace(first.integer(0), last.integer(0));
    }
  }

  bool has_time_index() {
    Statement rows(database_.get(), "PRAGMA index_list(messages)");
    return rows.step();
  }

  void begin() {
    std::string list;
    for (const auto& [id, topic] : topic_of_) {
      if (selected_.contains(topic)) list += (list.empty() ? "" : ",") + std::to_string(id);
    }
    // Of a cut file the index, which grows all along, is the first to be lost.
    const bool by_time = !cut_ && has_time_index();
    rows_ = std::make_unique<Statement>(
        database_.get(),
        "SELECT topic_id, timestamp, data, id FROM messages WHERE topic_id IN (" + list +
            ") ORDER BY " + (by_time ? "timestamp, id" : "id"));
  }

  bool step() {
    if (ended_) return false;
    try {
      if (!rows_) begin();
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

  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
  };

  ContainerFile file_;
  std::unique_ptr<sqlite3, Close> database_;
  std::unique_ptr<Statement> rows_;
  std::map<std::int64_t, std::size_t> topic_of_;
  std::vector<Topic> topics_;
  std::set<std::size_t> selected_;
  std::optional<std::pair<std::int64_t, std::int64_t>> time_range_;
  std::vector<std::byte> unpacked_;
  std::vector<ContainerDamage> damage_;
  std::vector<std::string> notes_;
  bool cut_ = false;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<MessageSource> open_sqlite_bag(const fs::path& path, bool count) {
  return std::make_unique<SqliteSource>(path, count);
}

}  // namespace kissmap
