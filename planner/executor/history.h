// What the executor ran, remembered over restarts: no trajectory runs twice.
#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <string>

#include "planner/protocol/execution_messages.h"

namespace fjr {

class History {
 public:
  struct Entry {
    RequestId id;
    std::optional<ResultCode> code;  // none: it never ended; the executor did
    std::string sentence;
  };

  // Reads the file if it is there. Throws InputError when it is no such file, std::runtime_error when it cannot be
  // read.
  explicit History(std::filesystem::path file);

  const Entry* find(const RequestId& id) const;
  std::uint64_t epoch() const { return epoch_; }  // the largest of what it ran

  // Both replace the file, complete or not at all, and return when it is on the disk. Throw std::runtime_error.
  void begin(const RequestId& id, std::uint64_t epoch);
  void end(const RequestId& id, ResultCode code, const std::string& sentence);

 private:
  void write() const;

  std::filesystem::path file_;
  std::uint64_t epoch_ = 0;
  std::deque<Entry> entries_;  // the oldest first
};

}  // namespace fjr
