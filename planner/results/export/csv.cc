#include <fmt/format.h>

#include <iterator>

#include "planner/results/export/formats.h"

namespace fjr {

std::string as_csv(const ExportTable& table) {
  fmt::memory_buffer text;
  const auto end = std::back_inserter(text);
  fmt::format_to(end, "{}\n", fmt::join(table.names, ","));
  for (std::size_t row = 0; row < table.rows(); ++row) {
    for (std::size_t i = 0; i < table.values.size(); ++i) {
      fmt::format_to(end, "{}{}", i == 0 ? "" : ",", table.values[i][row]);
    }
    fmt::format_to(end, "\n");
  }
  return fmt::to_string(text);
}

}  // namespace fjr
