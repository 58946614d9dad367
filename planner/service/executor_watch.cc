#include "planner/service/executor_watch.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace fjr {
namespace {

constexpr double kFresh = 0.5;             // [s] a state may be old; the executor's period is a millisecond
constexpr double kSameAsHeld = 0.01;       // [rad] the executor's own tolerance between a start and where the arm is
constexpr std::chrono::seconds kTaken{1};  // for the executor to show that it has taken up a trajectory

double seconds_since(std::int64_t stamp) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return 1e-9 * static_cast<double>(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count() - stamp);
}

const char* doing(ExecutorMode mode) {
  switch (mode) {
    case ExecutorMode::kResting:
    case ExecutorMode::kHolding:
      return "at rest";
    case ExecutorMode::kExecuting:
      return "executing a trajectory";
    case ExecutorMode::kStopping:
      return "stopping";
    case ExecutorMode::kStopped:
      return "stopped until it is started again";
    case ExecutorMode::kPreparing:
      return "about to execute a trajectory";
  }
  return "in an unknown mode";
}

bool at_rest(ExecutorMode mode) { return mode == ExecutorMode::kResting || mode == ExecutorMode::kHolding; }

// The position that is held rather than the encoders' word: a chain of motions must not pick up a count each time. Only
// an arm that is somewhere else altogether starts from where it is.
Pair<double> held_position(const ExecutorState& state) {
  Pair<double> q = state.planned_q;
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!(std::abs(q[j] - state.q[j]) <= kSameAsHeld)) q[j] = state.q[j];
  }
  return q;
}

}  // namespace

ExecutorWatch::ExecutorWatch(std::string robot_id, std::string robot_hash)
    : robot_id_(std::move(robot_id)), robot_hash_(std::move(robot_hash)) {}

void ExecutorWatch::heard(const ExecutorState& state) {
  if (state.robot_id == robot_id_) state_ = state;
}

void ExecutorWatch::lost(const std::string& robot_id) {
  if (robot_id == robot_id_) state_.reset();
}

void ExecutorWatch::published(const RequestId& trajectory_id) {
  published_ = trajectory_id;
  published_at_ = Clock::now();
}

bool ExecutorWatch::runs_or_ran(const RequestId& trajectory_id) const {
  return state_ && state_->trajectory_id == trajectory_id;
}

// What was published a moment ago may not show in the executor's state yet.
bool ExecutorWatch::about_to_move() const {
  return published_ && !runs_or_ran(*published_) && Clock::now() - published_at_ < kTaken;
}

std::variant<Pair<double>, std::string> ExecutorWatch::rest() const {
  if (!state_) return fmt::format("no executor of robot {} says where the arm is", robot_id_);
  if (state_->robot_hash != robot_hash_) {
    return fmt::format("the executor's robot has hash {}, the service's {}", state_->robot_hash, robot_hash_);
  }
  const double age = seconds_since(state_->stamp);
  if (!(std::abs(age) <= kFresh)) return fmt::format("the executor's last word is {:.1f} s old", age);
  if (!at_rest(state_->mode)) return fmt::format("the arm is {}", doing(state_->mode));
  if (!std::isfinite(state_->q[0] + state_->q[1])) {
    return fmt::format("the executor says that the arm is at {:.6g} and {:.6g} rad", state_->q[0], state_->q[1]);
  }
  if (about_to_move()) return std::string("the arm is about to execute a trajectory");
  return held_position(*state_);
}

}  // namespace fjr
