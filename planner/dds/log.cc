#include "planner/dds/log.h"

#include <dds/ddsrt/log.h>
#include <spdlog/spdlog.h>

#include <chrono>

#include "planner/protocol/printable.h"

namespace fjr::dds {
namespace {

constexpr std::chrono::seconds kPeriod{1};
constexpr std::size_t kLongestExample = 120;

void write_line(void* sink, const dds_log_data_t* data) {
  std::string_view text(data->message, data->size);
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.remove_suffix(1);
  static_cast<LogSink*>(sink)->write(text, (data->priority & (DDS_LC_ERROR | DDS_LC_FATAL)) != 0);
}

// Returns whether the line is about packets or samples that cannot be decoded.
bool about_malformed(std::string_view line) {
  return line.find("malformed packet") != line.npos || line.find("deserialization") != line.npos;
}

}  // namespace

LogSink::LogSink()
    : reporter_([this](const std::stop_token& over) {
        std::unique_lock lock(mutex_);
        while (!over.stop_requested()) {
          ending_.wait_for(lock, over, kPeriod, [] { return false; });
          report_malformed();
        }
      }) {
  dds_set_log_sink(write_line, this);
}

LogSink::~LogSink() { dds_set_log_sink(nullptr, nullptr); }

void LogSink::write(std::string_view line, bool error) {
  const std::lock_guard lock(mutex_);
  if (about_malformed(line)) {
    if (malformed_++ == 0) example_ = printable(line.substr(0, kLongestExample));
  } else if (limit_.allows()) {
    spdlog::log(error ? spdlog::level::err : spdlog::level::warn, "DDS: {}", printable(line));
  }
}

void LogSink::report_malformed() {
  if (malformed_ == 0) return;
  spdlog::warn("DDS: {} malformed packets or samples within a second, one of them: {}", malformed_, example_);
  malformed_ = 0;
}

}  // namespace fjr::dds
