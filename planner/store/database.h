// RAII classes for SQLite files: a connection, a statement, a transaction.
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

// Bytes to be bound as a BLOB; text would be interpreted as UTF-8.
struct Blob {
  std::string_view bytes;
};

// A prepared statement with its values bound: `while (statement.step()) statement.text(0);`. It must be destroyed
// before the Database it came from.
class Statement {
 public:
  bool step();   // goes to the first or the next row; returns false if there is none
  void reset();  // goes back to before the first row, to bind other values

  void bind(int index, std::nullptr_t);
  void bind(int index, double value);
  void bind(int index, std::string_view text);  // copied, as a Blob is
  void bind(int index, Blob blob);
  template <std::integral Integer>
  void bind(int index, Integer value) {
    bind_integer(index, static_cast<std::int64_t>(value));
  }
  // Binds all values in the order of the question marks.
  template <class... Values>
  Statement& with(const Values&... values) {
    int index = 0;
    (bind(++index, values), ...);
    return *this;
  }

  // Columns of the row, counted from 0.
  std::string text(int column) const;  // the bytes of a blob; empty for NULL
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

// All functions throw std::runtime_error naming the file, or InputError if the file is not an SQLite file. A connection
// that is locked out by another one waits for up to a minute.
class Database {
 public:
  // kWrite creates the file if necessary. Even kRead may write, because an incomplete transaction of a killed writer is
  // rolled back when the file is opened next.
  enum class Access { kRead, kWrite };

  Database(const std::filesystem::path& file, Access access);

  void execute(const std::string& statements) const;  // without values
  Statement prepare(std::string_view statement) const;
  // Returns the prepared statement with its values bound.
  template <class... Values>
  Statement query(std::string_view statement, const Values&... values) const {
    Statement prepared = prepare(statement);
    prepared.with(values...);
    return prepared;
  }
  // Runs the statement to its end.
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

// A transaction, which is rolled back if it is destroyed before it was committed.
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
