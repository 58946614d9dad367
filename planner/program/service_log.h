// The log of programs that run forever: stderr, one line an event, with time and level.
#pragma once

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "planner/dds/log.h"

namespace fjr {

// Has to be called before DDS is used. The returned object has to live as long as DDS is used.
[[nodiscard]] inline std::unique_ptr<dds::LogSink> log_to_stderr() {
  spdlog::set_default_logger(spdlog::stderr_color_mt("fjr"));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %l %v");
  return std::make_unique<dds::LogSink>();
}

}  // namespace fjr
