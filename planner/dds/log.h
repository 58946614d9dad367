// Redirects the messages of DDS to the program's log.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "planner/protocol/log_limit.h"

namespace fjr::dds {

// While it exists, lines of DDS go to the program's log. Their number per second is limited (log_limit.h), because
// other participants could cause one with every message. Malformed packets are counted and reported once a second. It
// must be created before DDS is used.
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
