#include "planner/ros2/action_server.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "common/input_error.h"
#include "planner/dds/participant.h"

namespace fjr {
namespace {

// Results are kept so long for whoever asks late, and of so many goals.
constexpr std::chrono::minutes kKeptFor{15};
constexpr std::size_t kMostKept = 64;
constexpr std::size_t kMostWaitingForResult = 64;  // of one goal
constexpr std::size_t kLongestActionName = 200;

std::int64_t now_ns() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(since).count();
}

std::string short_name(const GoalId& id) { return fmt::format("{:02x}{:02x}{:02x}{:02x}", id[0], id[1], id[2], id[3]); }

bool ended(GoalStatus status) { return status >= GoalStatus::kSucceeded; }

const char* word(GoalStatus status) {
  switch (status) {
    case GoalStatus::kSucceeded:
      return "succeeded";
    case GoalStatus::kCanceled:
      return "cancelled";
    default:
      return "aborted";
  }
}

// As ROS 2 asks of names: tokens of letters, digits and underscores, none beginning with a digit.
bool is_ros_name(const std::string& name) {
  if (name.size() < 2 || name.size() > kLongestActionName || name.front() != '/') return false;
  char before = 0;
  for (const char c : name) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'), digit = c >= '0' && c <= '9';
    if (!letter && !digit && c != '_' && c != '/') return false;
    if (before == '/' && (c == '/' || digit)) return false;
    if (before == '_' && c == '_') return false;
    before = c;
  }
  return before != '/';
}

std::string checked_action_name(const ActionServerConfig& config) {
  const std::string name =
      config.action.empty() ? fmt::format("/{}/follow_joint_trajectory", config.robot_id) : config.action;
  if (is_ros_name(name)) return name;
  throw InputError("--action", "",
                   fmt::format("'{}' is no full name of ROS 2, as in /arm/follow_joint_trajectory", name));
}

}  // namespace

ActionServer::ActionServer(const ActionServerConfig& config)
    : config_(config),
      action_(checked_action_name(config)),
      port_(dds::guarded_participant(config.network), action_, config.with_indices) {}

void ActionServer::run() {
  spdlog::info("action server {} for robot '{}' on DDS domain {}", action_, config_.robot_id, config_.network.domain);
  while (!stopping_) turn();
  if (execution_) execution_->cancel();
  while (execution_) turn();
  spdlog::info("ended");
}

void ActionServer::stop() {
  stopping_ = true;
  port_.wake();
}

void ActionServer::turn() {
  port_.wait(std::chrono::milliseconds(100));
  for (const auto& request : port_.take_goals()) take_goal(request);
  for (const auto& request : port_.take_cancels()) take_cancel(request);
  for (const auto& request : port_.take_result_requests()) take_result_request(request);
  look_at_execution();
  forget_old_goals();
  if (std::exchange(changed_, false)) publish_status();
}

void ActionServer::take_goal(const dds::FollowActionPort::GoalRequest& request) {
  const bool accepted = !stopping_ && find(request.id) == nullptr;
  const std::int64_t now = now_ns();
  port_.answer_goal(request.call, accepted, now);
  if (!accepted) return;
  Goal& goal = *goals_.emplace_back(std::make_unique<Goal>());
  goal.record = {request.id, now, GoalStatus::kAccepted};
  begin(goal, request.goal);
}

// What cannot be executed is accepted and aborted, for a goal that is not accepted has no result to say why.
void ActionServer::begin(Goal& goal, const FollowGoal& asked) {
  try {
    GoalRequest request = request_of(asked, config_.reading);
    if (execution_) {
      throw GoalRefused(ResultCode::kInvalidGoal,
                        fmt::format("goal {} is being executed; cancel it first, or wait", short_name(active_)));
    }
    const std::string name = "ros2_goal_" + short_name(goal.record.id);
    execution_ = std::make_unique<GoalExecution>(GoalExecution::Where{config_.network, config_.robot_id}, name,
                                                 std::move(request), [this] { port_.wake(); });
    active_ = goal.record.id;
    change(goal, GoalStatus::kExecuting);
    if (log_limit_.allows()) spdlog::info("goal {}: accepted", short_name(active_));
  } catch (const GoalRefused& refused) {
    end(goal, {GoalStatus::kAborted, {refused.code(), refused.what()}});
  }
}

void ActionServer::take_cancel(const dds::FollowActionPort::CancelRequest& request) {
  const bool any = request.id == GoalId{};
  Goal* const named = any ? nullptr : find(request.id);
  Goal* const running = active();
  const bool by_time = running != nullptr && running->record.accepted <= request.stamp_ns;
  const bool meant = running != nullptr && (running == named || (any && request.stamp_ns == 0) || by_time);
  if (meant) {
    change(*running, GoalStatus::kCanceling);
    execution_->cancel();
    return port_.answer_cancel(request.call, CancelCode::kNone, {running->record});
  }
  const CancelCode code = any || request.stamp_ns != 0 ? CancelCode::kRejected
                          : named == nullptr           ? CancelCode::kUnknownGoal
                                                       : CancelCode::kTerminated;
  port_.answer_cancel(request.call, code, {});
}

void ActionServer::take_result_request(const dds::FollowActionPort::ResultRequest& request) {
  Goal* const goal = find(request.id);
  if (goal == nullptr) return port_.answer_result(request.call, GoalStatus::kUnknown, {});
  if (ended(goal->record.status)) return port_.answer_result(request.call, goal->record.status, goal->result);
  if (goal->waiting.size() < kMostWaitingForResult) goal->waiting.push_back(request.call);
}

void ActionServer::look_at_execution() {
  if (!execution_) return;
  if (const auto feedback = execution_->take_feedback()) port_.publish_feedback(active_, *feedback, now_ns());
  auto outcome = execution_->take_outcome();
  if (!outcome) return;
  execution_.reset();
  if (Goal* const goal = find(active_)) end(*goal, std::move(*outcome));
}

void ActionServer::end(Goal& goal, GoalOutcome outcome) {
  goal.result = std::move(outcome.result);
  goal.ended = Clock::now();
  change(goal, outcome.status);
  for (const dds::Ros2Call& call : goal.waiting) port_.answer_result(call, goal.record.status, goal.result);
  goal.waiting.clear();
  if (!log_limit_.allows()) return;
  const char* const separator = goal.result.sentence.empty() ? "" : ": ";
  spdlog::info("goal {}: {}, {}{}{}", short_name(goal.record.id), word(goal.record.status), name(goal.result.code),
               separator, goal.result.sentence);
}

void ActionServer::change(Goal& goal, GoalStatus status) {
  goal.record.status = status;
  changed_ = true;
}

void ActionServer::forget_old_goals() {
  const auto now = Clock::now();
  std::size_t surplus = goals_.size() > kMostKept ? goals_.size() - kMostKept : 0;
  const std::size_t forgotten = std::erase_if(goals_, [&](const std::unique_ptr<Goal>& goal) {
    if (!ended(goal->record.status)) return false;
    if (surplus == 0) return now - goal->ended > kKeptFor;
    --surplus;
    return true;
  });
  changed_ = changed_ || forgotten > 0;
}

ActionServer::Goal* ActionServer::find(const GoalId& id) {
  const auto found =
      std::find_if(goals_.begin(), goals_.end(), [&](const auto& goal) { return goal->record.id == id; });
  return found == goals_.end() ? nullptr : found->get();
}

ActionServer::Goal* ActionServer::active() { return execution_ ? find(active_) : nullptr; }

void ActionServer::publish_status() {
  std::vector<GoalRecord> records;
  for (const auto& goal : goals_) records.push_back(goal->record);
  port_.publish_status(records);
}

}  // namespace fjr
