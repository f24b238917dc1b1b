// SPDX-License-Identifier: MIT
#pragma once

#include <sqlite3.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace kissmap {

/// A SQLite file that is read only. Not thread safe.
class SqliteDatabase {
 public:
  /// Throws Error(input).
  explicit SqliteDatabase(const std::filesystem::path& path);

  /// Otherwise SQLite reads nothing of a file that is shorter than its header says.
  void accept_missing_pages();

  /// Bytes of pages read from the file so far.
  std::uint64_t bytes_read() const;

  sqlite3* handle() const { return handle_.get(); }

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
  };
  std::unique_ptr<sqlite3, Close> handle_;
  std::uint64_t page_bytes_ = 0;
};

/// Rows that a query gives, one after the other. Not thread safe.
class SqliteRows {
 public:
  /// Throws Refusal where the database lacks what the query asks for. The database has to outlive
  /// the rows.
  SqliteRows(const SqliteDatabase& database, const std::string& query);
  ~SqliteRows() { sqlite3_finalize(statement_); }
  SqliteRows(const SqliteRows&) = delete;
  SqliteRows& operator=(const SqliteRows&) = delete;

  /// True for a row, false at the end. Throws Refusal for a damaged file.
  bool step();
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  std::string text(int column) const;
  std::span<const std::byte> blob(int column) const;  ///< valid until the next step
  bool is_null(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }

 private:
  sqlite3_stmt* statement_ = nullptr;
};

}  // namespace kissmap
