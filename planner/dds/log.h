// What DDS itself has to say, in the program's log.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "planner/protocol/log_limit.h"

namespace fjr::dds {

// As long as it lives, lines of DDS go to the program's log: a few a second at most, for others can cause one with
// every message they send. Packets that are none are counted, and told once a second. To be made before DDS is used.
class LogSink {
 public:
  LogSink();
  ~LogSink();
  LogSink(const LogSink&) = delete;
  LogSink& operator=(const LogSink&) = delete;

  void write(std::string_view line, bool error);

 private:
  void report_malformed();

  std::mutex mutex_;
  LogLimit limit_;
  int malformed_ = 0;  // since the last report
  std::string example_;
  std::condition_variable_any ending_;
  std::jthread reporter_;
};

}  // namespace fjr::dds
