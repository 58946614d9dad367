#include "planner/results/export/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <string_view>
#include <utility>

#include "common/strict_yaml.h"
#include "model/kinematics.h"
#include "planner/certificate/simulation.h"

namespace fjr {
namespace {

// Units as identifiers of MATLAB and Python may have them.
struct Quantity {
  const char* name;
  const char* unit;
};
constexpr Quantity kQ{"q", "rad"}, kDq{"dq", "rad_per_s"}, kTheta{"theta", "rad"}, kDtheta{"dtheta", "rad_per_s"},
    kTau{"tau", "N_m"};
constexpr Quantity kInLogs[] = {kDtheta, kTheta, kDq, kQ, kTau};  // the longer names first

void add_joints(ExportTable& table, const Quantity& quantity, const char* suffix, const Ticked& ticked,
                const std::function<const Joints<double>&(std::size_t)>& get) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    std::vector<double> column;
    for (std::size_t k = 0; k < ticked.rows.size(); ++k) column.push_back(get(k)[j]);
    table.add(fmt::format("{}{}{}_{}", quantity.name, j + 1, suffix, quantity.unit), std::move(column));
  }
}

// "theta1_plan" -> "theta1_plan_rad".
std::string with_unit(const std::string& column) {
  if (column == "time") return "time_s";
  for (const Quantity& quantity : kInLogs) {
    const std::string_view name = quantity.name;
    if (column.starts_with(name) && column.size() > name.size() && std::isdigit(column[name.size()]) != 0) {
      return fmt::format("{}_{}", column, quantity.unit);
    }
  }
  return column;
}

}  // namespace

void ExportTable::add(std::string name, std::vector<double> column) {
  names.push_back(std::move(name));
  values.push_back(std::move(column));
}

const std::vector<double>& ExportTable::column(const std::string& name) const {
  return values[static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin())];
}

Ticked at_ticks(const Parameters& robot, const Trajectory& trajectory, double tick) {
  constexpr double kRounding = 1e-9;  // fraction of a tick, because durations are sums of many numbers
  const double begin = trajectory.start_time(), end = trajectory.end_time();
  const std::optional<Sample> goal = held_after(robot, trajectory);
  const bool rests = goal.has_value();
  Trajectory held = trajectory;  // with the goal held after the end
  for (const double after : {kJumpSpacing, 2 * tick + kJumpSpacing}) {
    if (goal) held.samples.push_back({end + after, goal->state, goal->torque});
  }
  const double ticks = (end - begin) / tick;
  const auto last = static_cast<std::size_t>(rests ? std::ceil(ticks - kRounding) : std::floor(ticks + kRounding));
  Ticked result{tick, {}, {}};
  Interpolator states(held), torques(held);
  for (std::size_t k = 0; k <= last; ++k) {
    const double from = begin + static_cast<double>(k) * tick;
    const double to = rests ? from + tick : std::min(from + tick, end);
    result.rows.push_back(states.at(from));
    result.rows.back().time = from - begin;
    result.mean_torque.push_back(torques.mean_torque(from, to));
  }
  return result;
}

ExportTable table_of(const Parameters& robot, const Ticked& ticked) {
  ExportTable table;
  std::vector<double> time, x, y, speed;
  for (const Sample& row : ticked.rows) {
    const Point<double> tip = tip_position(robot, row.state.q);
    time.push_back(row.time);
    x.push_back(tip.x);
    y.push_back(tip.y);
    speed.push_back(std::sqrt(std::max(0.0, tip_speed_squared(robot, row.state.q[1], row.state.dq))));
  }
  const auto rows = [&](std::size_t k) -> const Sample& { return ticked.rows[k]; };
  table.add("time_s", std::move(time));
  add_joints(table, kQ, "", ticked, [&](std::size_t k) -> const Joints<double>& { return rows(k).state.q; });
  add_joints(table, kDq, "", ticked, [&](std::size_t k) -> const Joints<double>& { return rows(k).state.dq; });
  add_joints(table, kTheta, "", ticked, [&](std::size_t k) -> const Joints<double>& { return rows(k).state.theta; });
  add_joints(table, kDtheta, "", ticked, [&](std::size_t k) -> const Joints<double>& { return rows(k).state.dtheta; });
  add_joints(table, kTau, "", ticked, [&](std::size_t k) -> const Joints<double>& { return rows(k).torque; });
  add_joints(table, kTau, "_mean", ticked,
             [&](std::size_t k) -> const Joints<double>& { return ticked.mean_torque[k]; });
  table.add("tip_x_m", std::move(x));
  table.add("tip_y_m", std::move(y));
  table.add("tip_speed_m_per_s", std::move(speed));
  return table;
}

ExportTable table_of(const Log& log) {
  ExportTable table;
  for (std::size_t i = 0; i < log.names.size(); ++i) table.add(with_unit(log.names[i]), log.values[i]);
  return table;
}

}  // namespace fjr
