// SPDX-License-Identifier: MIT
#include "formats/containers/sqlite_database.hpp"

#include <cctype>

#include "formats/clouds/refusal.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

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

}  // namespace

SqliteDatabase::SqliteDatabase(const fs::path& path) {
  // A log of changes beside the file belongs to it; without one nothing is written anywhere.
  std::error_code no_file;
  const fs::path changes = path.string() + "-wal";
  const bool has_changes = fs::exists(changes, no_file) && fs::file_size(changes, no_file) > 0;
  const std::string uri = uri_of(path, has_changes ? "?mode=ro" : "?mode=ro&immutable=1");
  sqlite3* raw = nullptr;
  const int result =
      sqlite3_open_v2(uri.c_str(), &raw, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  handle_.reset(raw);
  if (result != SQLITE_OK) {
    throw input_error(
        path,
        std::string("cannot be opened: ") + sqlite3_errmsg(raw) +
            (has_changes ? "; its -wal file wants a folder that can be written, copy both to one"
                         : ""));
  }
  try {
    SqliteRows size(*this, "PRAGMA page_size");
    if (size.step()) page_bytes_ = static_cast<std::uint64_t>(size.integer(0));
  } catch (const Refusal&) {
    // No database: whatever is asked of it first will tell.
  }
}

void SqliteDatabase::accept_missing_pages() {
  SqliteRows(*this, "PRAGMA writable_schema=ON").step();
}

std::uint64_t SqliteDatabase::bytes_read() const {
  int pages = 0;
  int highest = 0;
  sqlite3_db_status(handle_.get(), SQLITE_DBSTATUS_CACHE_MISS, &pages, &highest, 0);
  return static_cast<std::uint64_t>(pages) * page_bytes_;
}

SqliteRows::SqliteRows(const SqliteDatabase& database, const std::string& query) {
  if (sqlite3_prepare_v2(database.handle(), query.c_str(), -1, &statement_, nullptr) != SQLITE_OK) {
    throw Refusal(refusal_reason::broken_content, sqlite3_errmsg(database.handle()));
  }
}

bool SqliteRows::step() {
  const int result = sqlite3_step(statement_);
  if (result == SQLITE_ROW) return true;
  if (result == SQLITE_DONE) return false;
  throw Refusal(refusal_reason::broken_content, sqlite3_errmsg(sqlite3_db_handle(statement_)));
}

std::string SqliteRows::text(int column) const {
  const auto* chars = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  return chars == nullptr ? "" : chars;
}

std::span<const std::byte> SqliteRows::blob(int column) const {
  const auto* bytes = static_cast<const std::byte*>(sqlite3_column_blob(statement_, column));
  return {bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

}  // namespace kissmap
