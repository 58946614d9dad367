#include "planner/ros2/goal_execution.h"

#include <exception>
#include <utility>

#include "planner/client/client.h"
#include "planner/client/halt.h"

namespace fjr {
namespace {

constexpr double kFeedbackPeriod = 0.02;  // [s]

std::string reason_of_reply(const Reply& reply) {
  const std::string state = name(reply.state);
  const std::string where = reply.why.field.empty() ? "" : reply.why.field + ": ";
  return state + ": " + where + reply.why.sentence;
}

}  // namespace

GoalExecution::GoalExecution(const Where& where, std::string name, GoalRequest request, std::function<void()> wake)
    : where_(where), name_(std::move(name)), request_(std::move(request)), wake_(std::move(wake)), thread_([this] {
        run();
      }) {}

GoalExecution::~GoalExecution() { cancel(); }

std::optional<FollowFeedback> GoalExecution::take_feedback() {
  const std::lock_guard lock(mutex_);
  return std::exchange(feedback_, std::nullopt);
}

std::optional<GoalOutcome> GoalExecution::take_outcome() {
  const std::lock_guard lock(mutex_);
  return std::exchange(outcome_, std::nullopt);
}

void GoalExecution::run() {
  GoalOutcome ended;
  try {
    ended = outcome();
  } catch (const NobodyAsked&) {
    ended = {GoalStatus::kCanceled, {ResultCode::kInvalidGoal, "cancelled before a service was found"}};
  } catch (const std::exception& error) {  // nobody plans or executes, or whoever does is silent
    ended.result = {ResultCode::kInvalidGoal, error.what()};
  }
  {
    const std::lock_guard lock(mutex_);
    outcome_ = std::move(ended);
  }
  wake_();
}

GoalOutcome GoalExecution::outcome() {
  Order order;
  order.id = new_client();
  order.name = name_;
  order.action = Action::kPlanAndExecute;
  order.robot_id = where_.robot_id;
  order.document = request_.document;
  ClientOptions client;
  client.network = where_.network;
  client.cancelled = [this] { return cancelled_ || strayed_; };
  client.on_execution = [this](const ExecutionProgress& progress) { follow(progress.time, progress.state); };
  client.stop_execution = [this](const std::string& robot_id) {
    (void)halt(ExecutorCommand::kHold, {.network = where_.network, .robot_id = robot_id});
  };
  const Answer answer = request_plan(order, client);
  if (answer.result) return executed(*answer.result);
  const bool cancelled = answer.reply.state == ReplyState::kCancelled && cancelled_;
  return {cancelled ? GoalStatus::kCanceled : GoalStatus::kAborted,
          {ResultCode::kInvalidGoal, reason_of_reply(answer.reply)}};
}

// A cancelled goal may have been reached before the arm was held; and what made the executor stop the arm by itself is
// no cancellation.
GoalOutcome GoalExecution::executed(const ExecutionResult& result) const {
  if (strayed_) return {GoalStatus::kAborted, *strayed_};
  const FollowResult verdict = judged(request_, result);
  if (verdict.code == ResultCode::kSuccessful) return {GoalStatus::kSucceeded, verdict};
  const bool held = result.code != ResultCode::kSuccessful && result.code != ResultCode::kPathToleranceViolated;
  return {cancelled_ && held ? GoalStatus::kCanceled : GoalStatus::kAborted, verdict};
}

void GoalExecution::follow(double time, const ExecutorState& state) {
  if (!strayed_) strayed_ = strayed(request_, state);
  if (time - told_ < kFeedbackPeriod && told_ > 0) return;
  told_ = time;
  {
    const std::lock_guard lock(mutex_);
    feedback_ = feedback_of(request_, time, state);
  }
  wake_();
}

}  // namespace fjr
