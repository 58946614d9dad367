#include "planner/service/dds/log.h"

#include <dds/ddsrt/log.h>

#include <mutex>
#include <string_view>

#include "planner/service/log_limit.h"

namespace fjr::dds {
namespace {

void write_line(void*, const dds_log_data_t* data) {
  static std::mutex mutex;
  static LogLimit limit;
  const std::lock_guard lock(mutex);
  if (!limit.allows()) return;
  std::string_view text(data->message, data->size);
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.remove_suffix(1);
  spdlog::log((data->priority & (DDS_LC_ERROR | DDS_LC_FATAL)) != 0 ? spdlog::level::err : spdlog::level::warn,
              "DDS: {}", text);
}

}  // namespace

void log_as_the_program_does() { dds_set_log_sink(write_line, nullptr); }

}  // namespace fjr::dds
