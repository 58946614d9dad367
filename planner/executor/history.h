// Remembers over restarts which trajectories the executor ran, so that none runs twice.
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
    std::optional<ResultCode> code;  // empty if the executor ended before the trajectory did
    std::string sentence;
  };

  // Reads the file if it exists. Throws InputError if it has another format, std::runtime_error if it cannot be read.
  explicit History(std::filesystem::path file);

  const Entry* find(const RequestId& id) const;
  std::uint64_t epoch() const { return epoch_; }  // the largest epoch of all trajectories it ran

  // Record that a trajectory begins or has ended. Both replace the file atomically and return when it is on the disk.
  // They throw std::runtime_error if that fails.
  void begin(const RequestId& id, std::uint64_t epoch);
  void end(const RequestId& id, ResultCode code, const std::string& sentence);

 private:
  void write() const;

  std::filesystem::path file_;
  std::uint64_t epoch_ = 0;
  std::deque<Entry> entries_;  // the oldest first
};

}  // namespace fjr
