// SQLite files: a connection, a statement, a transaction, each of which ends itself.
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace fjr {

// Bytes, where text would be taken for UTF-8.
struct Blob {
  std::string_view bytes;
};

// A prepared statement with its values bound: `while (statement.step()) statement.text(0);`. It has to go before the
// Database it came from.
class Statement {
 public:
  bool step();   // to the first row, to the next one; false: there is none
  void reset();  // to before the first row, for other values

  void bind(int index, std::nullptr_t);
  void bind(int index, double value);
  void bind(int index, std::string_view text);  // copied, as a Blob is
  void bind(int index, Blob blob);
  template <std::integral Integer>
  void bind(int index, Integer value) {
    bind_integer(index, static_cast<std::int64_t>(value));
  }
  // All of them, in the order of the question marks.
  template <class... Values>
  Statement& with(const Values&... values) {
    int index = 0;
    (bind(++index, values), ...);
    return *this;
  }

  // Columns of the row, counted from 0.
  std::string text(int column) const;  // of a blob its bytes; of NULL nothing
  std::int64_t integer(int column) const;
  double real(int column) const;

 private:
  friend class Database;
  explicit Statement(sqlite3_stmt* statement);
  void bind_integer(int index, std::int64_t value);

  struct Finalise {
    void operator()(sqlite3_stmt* statement) const;
  };
  std::unique_ptr<sqlite3_stmt, Finalise> statement_;
};

// Everything throws std::runtime_error naming the file, and InputError where the file is none of SQLite's. A connection
// that is locked out by another one waits for up to a minute.
class Database {
 public:
  // kWrite makes the file where it is not there. kRead may write nevertheless: what a killed writer has left half done
  // is undone by whoever opens the file next.
  enum class Access { kRead, kWrite };

  Database(const std::filesystem::path& file, Access access);

  void execute(const std::string& statements) const;  // without values
  Statement prepare(std::string_view statement) const;
  // Prepared, with its values bound.
  template <class... Values>
  Statement query(std::string_view statement, const Values&... values) const {
    Statement prepared = prepare(statement);
    prepared.with(values...);
    return prepared;
  }
  // Run to its end.
  template <class... Values>
  void run(std::string_view statement, const Values&... values) const {
    Statement prepared = query(statement, values...);
    while (prepared.step()) {
    }
  }

 private:
  struct Close {
    void operator()(sqlite3* connection) const;
  };
  std::unique_ptr<sqlite3, Close> connection_;
};

// All or nothing: what was not committed when it goes is undone.
class Transaction {
 public:
  explicit Transaction(const Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  const Database& database_;
  bool open_ = true;
};

}  // namespace fjr
