// Strict reading and reproducible writing of trajectory.csv.
#include "common/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "planner/trajectory/finite.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {
namespace {

// The columns stand in the order of Sample: time, the eight values of the state, the torque.
constexpr std::array<std::string_view, 1 + kStates + kControls> kColumns = {
    "time", "q1", "q2", "dq1", "dq2", "theta1", "theta2", "dtheta1", "dtheta2", "tau1", "tau2"};

using Values = std::array<double, kColumns.size()>;

Sample to_sample(const Values& values) {
  return {values[0], State<double>::from(&values[1]), {values[1 + kStates], values[2 + kStates]}};
}

Values to_values(const Sample& sample) {
  Values values;
  values[0] = sample.time;
  sample.state.copy_to(&values[1]);
  std::copy_n(sample.torque.data(), kControls, &values[1 + kStates]);
  return values;
}

}  // namespace

Trajectory parse_csv(std::istream& in, const std::string& source) {
  CsvTable table = read_table(in, source, {"trajectory", {kColumns.begin(), kColumns.end()}, nullptr, {}, kMaxRows});
  Trajectory trajectory;
  trajectory.metadata = std::move(table.metadata);
  for (std::size_t row = 0; row < table.values.front().size(); ++row) {
    Values values;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = table.values[i][row];
    trajectory.samples.push_back(to_sample(values));
  }
  return trajectory;
}

Trajectory read_csv(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (error && std::filesystem::exists(status)) throw InputError(file.string(), "", error.message());
  if (!std::filesystem::exists(status)) throw InputError(file.string(), "", "no such file");
  if (std::filesystem::is_directory(status)) throw InputError(file.string(), "", "is a folder, not a trajectory file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file.string(), "", "cannot be opened for reading");
  return parse_csv(in, file.string());
}

void format_csv(const Trajectory& trajectory, std::ostream& out) {
  fmt::memory_buffer text;
  const auto end = std::back_inserter(text);
  fmt::format_to(end, "{}", format_metadata(trajectory.metadata));
  fmt::format_to(end, "{}\n", fmt::join(kColumns, ","));
  for (const Sample& sample : trajectory.samples) {
    if (!is_finite(sample)) throw std::invalid_argument(fmt::format("a row near {} s is not finite", sample.time));
    fmt::format_to(end, "{}\n",
                   fmt::join(to_values(sample), ","));  // the shortest text that reads back to the same bits
  }
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
}

std::optional<std::string> rows_missing(const Trajectory& trajectory) {
  const auto told = trajectory.metadata.find("rows");
  if (told == trajectory.metadata.end() || told->second == std::to_string(trajectory.samples.size()))
    return std::nullopt;
  return fmt::format("the file has {} rows, but says that it had {}", trajectory.samples.size(), told->second);
}

void write_csv(const Trajectory& trajectory, const std::filesystem::path& file) {
  std::ostringstream text;
  format_csv(trajectory, text);
  write_file(file, text.view());
}

}  // namespace fjr
