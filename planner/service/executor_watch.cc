#include "planner/service/executor_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fjr {
namespace {

constexpr double kFresh = 0.5;             // [s] a state may be old; the executor's period is a millisecond
constexpr std::chrono::seconds kTaken{1};  // until the executor's state shows that it has accepted a trajectory

double age_of(ExecutorWatch::Clock::time_point then,
              ExecutorWatch::Clock::time_point now = ExecutorWatch::Clock::now()) {
  return std::chrono::duration<double>(now - then).count();
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

// Returns the link positions from which a motion should start: the held reference instead of the encoder readings,
// because otherwise a sequence of motions would drift by a count each time. The reading of a joint is used only if it
// is more than kStartTolerance off.
Joints<double> held_position(const ExecutorState& state) {
  Joints<double> q = state.planned_q;
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!(std::abs(q[j] - state.q[j]) <= kStartTolerance)) q[j] = state.q[j];
  }
  return q;
}

}  // namespace

ExecutorWatch::ExecutorWatch(std::string robot_id, std::string robot_hash)
    : robot_id_(std::move(robot_id)), robot_hash_(std::move(robot_hash)) {}

void ExecutorWatch::heard(const ExecutorState& state, std::uint64_t source, Clock::time_point now) {
  if (state.robot_id != robot_id_) return;
  std::erase_if(speakers_, [&](const Speaker& speaker) {
    return speaker.source == source || age_of(speaker.heard, now) > kFresh;
  });
  speakers_.push_back({source, state, now});
  met_ = true;
}

void ExecutorWatch::lost(const std::string& robot_id) {
  if (robot_id == robot_id_) speakers_.clear();
}

void ExecutorWatch::published(const RequestId& trajectory_id) {
  published_ = trajectory_id;
  published_at_ = Clock::now();
}

void ExecutorWatch::concluded(const RequestId& trajectory_id) {
  if (published_ == trajectory_id) published_.reset();
}

std::optional<ExecutorState> ExecutorWatch::latest() const {
  if (speakers_.empty() || age_of(speakers_.back().heard) > kFresh) return std::nullopt;
  return speakers_.back().state;
}

std::uint64_t ExecutorWatch::source() const { return speakers_.empty() ? 0 : speakers_.back().source; }

std::optional<std::uint64_t> ExecutorWatch::epoch() const {
  if (speakers_.empty()) return std::nullopt;
  return std::min_element(speakers_.begin(), speakers_.end(),
                          [](const Speaker& a, const Speaker& b) { return a.state.epoch < b.state.epoch; })
      ->state.epoch;
}

bool ExecutorWatch::runs_or_ran(const RequestId& trajectory_id) const {
  return std::any_of(speakers_.begin(), speakers_.end(),
                     [&](const Speaker& speaker) { return speaker.state.trajectory_id == trajectory_id; });
}

std::int64_t ExecutorWatch::stamp() const {
  if (speakers_.empty()) return own_clock_.now();
  const Speaker& last = speakers_.back();
  return last.state.stamp + std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - last.heard).count();
}

std::optional<std::string> ExecutorWatch::twice() const {
  const auto fresh = std::count_if(speakers_.begin(), speakers_.end(),
                                   [](const Speaker& speaker) { return age_of(speaker.heard) <= kFresh; });
  if (fresh < 2) return std::nullopt;
  return fmt::format("{} executors report for robot {}: all but one have to be stopped", fresh, robot_id_);
}

std::optional<std::string> ExecutorWatch::stopped() const {
  const auto state = latest();
  if (!state || state->mode != ExecutorMode::kStopped) return std::nullopt;
  return fmt::format("the arm is {}", doing(state->mode));
}

// Returns whether a published trajectory may still start. Its acceptance may not show in the executor's state yet.
bool ExecutorWatch::about_to_move() const {
  return published_ && !runs_or_ran(*published_) && Clock::now() - published_at_ < kTaken;
}

std::variant<Joints<double>, std::string> ExecutorWatch::rest() const {
  if (speakers_.empty()) return fmt::format("no executor of robot {} says where the arm is", robot_id_);
  if (auto why = twice()) return *std::move(why);
  const auto& [source, state, heard] = speakers_.back();
  if (state.robot_hash != robot_hash_) {
    return fmt::format("the executor's robot has hash {}, the service's {}", state.robot_hash, robot_hash_);
  }
  const double age = age_of(heard);
  if (age > kFresh) return fmt::format("the executor's last word is {:.1f} s old", age);
  if (!at_rest(state.mode)) return fmt::format("the arm is {}", doing(state.mode));
  if (!std::isfinite(state.q[0] + state.q[1])) {
    return fmt::format("the executor says that the arm is at {:.6g} and {:.6g} rad", state.q[0], state.q[1]);
  }
  if (about_to_move()) return std::string("the arm is about to execute a trajectory");
  return held_position(state);
}

}  // namespace fjr
