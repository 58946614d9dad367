// The log of programs that run forever: stderr, one line an event, with time and level.
#pragma once

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "planner/service/dds/log.h"

namespace fjr {

inline void log_to_stderr() {
  spdlog::set_default_logger(spdlog::stderr_color_mt("fjr"));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %l %v");
  dds::log_as_the_program_does();
}

}  // namespace fjr
