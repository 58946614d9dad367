#include "planner/store/database.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <exception>
#include <stdexcept>

#include "common/input_error.h"

namespace fjr {
namespace {

constexpr int kPatienceMs = 60'000;

[[noreturn]] void fail(sqlite3* connection, int code) {
  const char* const name = ::sqlite3_db_filename(connection, "main");
  const std::string file = name == nullptr ? "SQLite" : name;
  const std::string problem = ::sqlite3_errmsg(connection);
  if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT) throw InputError(file, "", problem);
  throw std::runtime_error(fmt::format("{}: {}", file, problem));
}

}  // namespace

// ---- statements ----

Statement::Statement(sqlite3_stmt* statement) : statement_(statement) {}
void Statement::Finalise::operator()(sqlite3_stmt* statement) const { ::sqlite3_finalize(statement); }

bool Statement::step() {
  const int code = ::sqlite3_step(statement_.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE) fail(::sqlite3_db_handle(statement_.get()), code);
  return code == SQLITE_ROW;
}

void Statement::reset() {
  ::sqlite3_reset(statement_.get());
}  // its return code repeats the error of step(), which has thrown

namespace {

void check_bound(sqlite3_stmt* statement, int code) {
  if (code != SQLITE_OK) fail(::sqlite3_db_handle(statement), code);
}

}  // namespace

void Statement::bind(int index, std::nullptr_t) {
  check_bound(statement_.get(), ::sqlite3_bind_null(statement_.get(), index));
}

void Statement::bind(int index, double value) {
  check_bound(statement_.get(), ::sqlite3_bind_double(statement_.get(), index, value));
}

void Statement::bind_integer(int index, std::int64_t value) {
  check_bound(statement_.get(), ::sqlite3_bind_int64(statement_.get(), index, value));
}

void Statement::bind(int index, std::string_view text) {
  check_bound(statement_.get(),
              ::sqlite3_bind_text64(statement_.get(), index, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
}

void Statement::bind(int index, Blob blob) {
  check_bound(statement_.get(),
              ::sqlite3_bind_blob64(statement_.get(), index, blob.bytes.data(), blob.bytes.size(), SQLITE_TRANSIENT));
}

std::string Statement::text(int column) const {
  const void* const bytes = ::sqlite3_column_blob(statement_.get(), column);
  const int size = ::sqlite3_column_bytes(statement_.get(), column);
  return bytes == nullptr ? std::string()
                          : std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(size));
}

std::int64_t Statement::integer(int column) const { return ::sqlite3_column_int64(statement_.get(), column); }
double Statement::real(int column) const { return ::sqlite3_column_double(statement_.get(), column); }

// ---- connections ----

void Database::Close::operator()(sqlite3* connection) const { ::sqlite3_close_v2(connection); }

Database::Database(const std::filesystem::path& file, Access access) {
  const int flags = SQLITE_OPEN_READWRITE | (access == Access::kWrite ? SQLITE_OPEN_CREATE : 0);
  sqlite3* connection = nullptr;
  const int code = ::sqlite3_open_v2(file.c_str(), &connection, flags, nullptr);
  connection_.reset(connection);
  if (connection == nullptr) throw std::bad_alloc();
  if (code != SQLITE_OK) {
    throw std::runtime_error(fmt::format("cannot open {}: {}", file.string(), ::sqlite3_errmsg(connection)));
  }
  ::sqlite3_busy_timeout(connection, kPatienceMs);
}

void Database::execute(const std::string& statements) const {
  const int code = ::sqlite3_exec(connection_.get(), statements.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(connection_.get(), code);
}

Statement Database::prepare(std::string_view statement) const {
  sqlite3_stmt* prepared = nullptr;
  const int code =
      ::sqlite3_prepare_v2(connection_.get(), statement.data(), static_cast<int>(statement.size()), &prepared, nullptr);
  if (code != SQLITE_OK) fail(connection_.get(), code);
  return Statement(prepared);
}

// ---- transactions ----

// With IMMEDIATE two writers take turns. Otherwise both could begin with a read that the other's write makes stale.
Transaction::Transaction(const Database& database) : database_(database) { database_.execute("BEGIN IMMEDIATE"); }

void Transaction::commit() {
  database_.execute("COMMIT");
  open_ = false;
}

Transaction::~Transaction() {
  if (!open_) return;
  try {
    database_.execute("ROLLBACK");
  } catch (const std::exception&) {  // it is undone all the same when the connection closes
  }
}

}  // namespace fjr
