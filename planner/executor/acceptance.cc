#include "planner/executor/acceptance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/protocol/epoch.h"
#include "planner/trajectory/finite.h"

namespace fjr {
namespace {

constexpr double kSpacingRounding = 1e-9;  // [s]

bool stands_still(const Sample& row) {
  constexpr double kStill = 1e-4;  // [rad/s]
  const auto still = [](const Joints<double>& v) { return std::abs(v[0]) <= kStill && std::abs(v[1]) <= kStill; };
  return still(row.state.dq) && still(row.state.dtheta);
}

// Checks the tolerances. Returns what is wrong, if anything.
std::optional<std::string> fault_of(const Tolerances& t) {
  std::optional<std::string> fault;
  const auto check = [&fault](const char* name, double value, double most) {
    if (fault || (value >= 0 && value <= most)) return;
    fault = fmt::format("tolerances.{}: {} is outside [0, {}]", name, value, most);
  };
  for (std::size_t j = 0; j < kJoints; ++j) {
    check("path", t.path[j], kWidestTolerance);
    check("goal", t.goal[j], kWidestTolerance);
    check("stopped_velocity", t.stopped_velocity[j], kWidestTolerance);
  }
  check("goal_time", t.goal_time, kLongestGoalTime);
  return fault;
}

// Checks the form of the samples and returns what is wrong, if anything. Whether the arm can follow them is judged
// later, while the motion is prepared.
std::optional<std::string> fault_of(const std::vector<Sample>& rows) {
  if (rows.size() < 2 || rows.size() > kMaxRows) {
    return fmt::format("{} rows; a trajectory has at least 2 and at most {}", rows.size(), kMaxRows);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!is_finite(rows[i])) return fmt::format("row {} is not finite", i);
    if (i == 0) continue;
    const double since = rows[i].time - rows[i - 1].time;
    if (!(since > 0)) return fmt::format("time does not increase at row {}", i);
    if (since < kShortestSpacing || since > kLongestSpacing + kSpacingRounding) {
      return fmt::format("row {} is {:.6g} s after the row before, {:g} to {:g} s are allowed", i, since,
                         kShortestSpacing, kLongestSpacing);
    }
  }
  if (rows.front().time != 0) return fmt::format("begins at {} s instead of 0 s", rows.front().time);
  if (rows.back().time > kLongestMotion) {
    return fmt::format("takes {} s, more than {} s", rows.back().time, kLongestMotion);
  }
  if (!stands_still(rows.front())) return "does not begin at rest";
  if (!stands_still(rows.back())) return "does not end at rest";
  return std::nullopt;
}

double age(const TrajectoryOrder& order, const Situation& situation) {
  return static_cast<double>(situation.now - order.published) * 1e-9;
}

}  // namespace

std::optional<ExecutionRefusal> refusal_of(const TrajectoryOrder& order, const Situation& situation) {
  const auto invalid = [](std::string sentence) {
    return ExecutionRefusal{ResultCode::kInvalidGoal, std::move(sentence)};
  };
  if (order.robot_hash != situation.robot_hash) {
    return ExecutionRefusal{ResultCode::kInvalidJoints,
                            "planned for another robot, or another payload: " + order.robot_hash};
  }
  if (!order.certified) return invalid("not certified");
  if (!order.ends_at_rest) return invalid("does not end at rest");
  if (const auto fault = fault_of(order.rows)) return invalid(*fault);
  if (const auto fault = fault_of(order.tolerances)) return invalid(*fault);
  if (order.epoch < situation.epoch) {
    return invalid(fmt::format("from an earlier owner: epoch {}, {} was seen", order.epoch, situation.epoch));
  }
  if (order.epoch > largest_believed(situation.epoch)) {
    return invalid(fmt::format("epoch {} is not that of an owner: the largest seen is {}, and each owner adds one",
                               order.epoch, situation.epoch));
  }
  if (order.published < situation.started) {
    return ExecutionRefusal{ResultCode::kOldHeaderTimestamp, "published before the executor was started"};
  }
  if (order.published < situation.halted) {  // a halt also applies to trajectories that were still on their way
    return ExecutionRefusal{ResultCode::kOldHeaderTimestamp, "published before the arm was told to hold"};
  }
  if (age(order, situation) < -kClockDifference) {  // with wrong clocks, an old trajectory would not be recognised
    return ExecutionRefusal{ResultCode::kOldHeaderTimestamp,
                            fmt::format("published {:.3f} s in the future: the clocks of planner and executor differ",
                                        -age(order, situation))};
  }
  if (!(age(order, situation) <= situation.oldest)) {
    return ExecutionRefusal{ResultCode::kOldHeaderTimestamp, fmt::format("published {:.1f} s ago, more than {} s",
                                                                         age(order, situation), situation.oldest)};
  }
  if (situation.mode != ExecutorMode::kResting && situation.mode != ExecutorMode::kHolding) {
    return invalid(situation.mode == ExecutorMode::kStopped     ? "the executor was stopped; it has to be restarted"
                   : situation.mode == ExecutorMode::kPreparing ? "another trajectory is being prepared"
                                                                : "the arm is not at rest");
  }
  if (!situation.lost.empty()) return invalid("the encoder " + situation.lost + " gives no samples");
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double start = order.rows.front().state.q[j];
    if (!(std::abs(start - situation.q[j]) <= kStartTolerance)) {
      return invalid(fmt::format("starts at q{} = {:.6g} rad, the arm is at {:.6g} rad", j + 1, start, situation.q[j]));
    }
    const double theta = order.rows.front().state.theta[j], rest = situation.rest_theta[j] + start - situation.q[j];
    const double off = std::abs(theta - rest), moved = std::abs(theta - situation.theta[j]);
    if (!((order.learnt ? std::min(off, moved) : off) <= kStartTolerance)) {
      return invalid(
          fmt::format("starts with theta{} = {:.6g} rad, at rest there it is {:.6g} rad", j + 1, theta, rest));
    }
  }
  return std::nullopt;
}

}  // namespace fjr
