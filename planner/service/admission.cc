#include "planner/service/admission.h"

#include <fmt/format.h>

#include "planner/problem/problem.h"
#include "planner/request/request.h"
#include "planner/request/request_keys.h"
#include "planner/service/presence.h"

namespace fjr {
namespace {

// Holding and stopping go by the executor's own robot.yaml, and a trajectory has no place for a payload.
constexpr const char* kOtherPayload =
    "the executor does not know of it: to be executed it has to be in the robot.yaml of service and executor";

}  // namespace

std::optional<Refusal> read_motion(Order& order) try {
  if (!order.motion) order.motion = read_request(YamlNode::parse(order.document, order.name));
  return std::nullopt;
} catch (const InputError& error) {
  return refusal_of(error);
}

Refusal refusal_of(const InputError& error) {
  return {Reason::kBadInput, error.field().empty() ? "document" : error.field(), error.problem()};
}

std::optional<Refusal> refusal_of_terms(const Order& order, const Served& served) {
  if (order.refusal) return order.refusal;
  if (order.robot_id.empty() && served.robots.size() > 1) {
    return Refusal{Reason::kWrongRobot, "robot_id",
                   fmt::format("several robots are served ({}): name one", fmt::join(served.robots, ", "))};
  }
  if (!order.robot_id.empty() && order.robot_id != served.robot_id) {
    return Refusal{Reason::kWrongRobot, "robot_id",
                   fmt::format("{} is not served; there is {}", order.robot_id, fmt::join(served.robots, ", "))};
  }
  if (!order.robot_hash.empty() && order.robot_hash != served.robot_hash) {
    return Refusal{Reason::kWrongRobot, "robot", "the service plans for the robot with hash " + served.robot_hash};
  }
  if (order.budget > served.longest_budget) {
    return Refusal{Reason::kBadInput, "budget", fmt::format("{} s is above {} s", order.budget, served.longest_budget)};
  }
  if (order.start_within > served.longest_budget) {
    return Refusal{Reason::kBadInput, "start_within",
                   fmt::format("{} s is above {} s", order.start_within, served.longest_budget)};
  }
  if (order.start_within > 0 && order.start_within < kLeastStartWithin) {
    return Refusal{Reason::kBadInput, "start_within",
                   fmt::format("{} s is below the {} s within which a client can be asked whether it is there",
                               order.start_within, kLeastStartWithin)};
  }
  return std::nullopt;
}

std::optional<Refusal> refusal_of_motion(Job& job, const Parameters& robot) {
  try {
    const Problem problem = resolve_for(job.request, robot);
    job.request_hash = problem.request_hash;
    job.robot_hash = robot_hash(problem.robot);
    job.rest_to_rest = problem.start_at_rest && problem.goal.at_rest;
    if (!executes(job.order)) return std::nullopt;
    if (problem.duration.min > kLongestMotion) {
      return Refusal{
          Reason::kBadInput, "duration",
          fmt::format("{:g} s is longer than the {:g} s that an executor runs", problem.duration.min, kLongestMotion)};
    }
    if (problem.robot.payload != robot.payload) return Refusal{Reason::kBadInput, "payload", kOtherPayload};
    if (job.rest_to_rest) return std::nullopt;
    return Refusal{Reason::kBadInput, problem.start_at_rest ? "goal" : "start", "must be at rest to be executed"};
  } catch (const InputError& error) {
    return refusal_of(error);
  }
}

std::optional<Refusal> refusal_at_sight(Order& order, const Served& served, const Parameters& robot) {
  if (auto refusal = refusal_of_terms(order, served)) return refusal;
  if (of_earlier_plan(order.action)) return std::nullopt;
  if (auto refusal = read_motion(order)) return refusal;
  if (leaves_start_out(order)) return std::nullopt;
  Job job;
  job.order = order;
  job.request = *order.motion;
  return refusal_of_motion(job, robot);
}

std::optional<Refusal> refusal_of_execution(const RequestId& id, const SharedReply& planned, bool in_hand,
                                            const std::string& robot_hash) {
  const auto refused = [&](const std::string& why) {
    return Refusal{Reason::kNoTrajectory, "trajectory_id", fmt::format("{} {}", text(id), why)};
  };
  if (in_hand) return refused("is still being planned");
  if (!planned) return refused("is not among the requests this service has planned lately; have it planned again");
  if (planned->state != ReplyState::kSolved) return refused(fmt::format("ended as {}", name(planned->state)));
  if (planned->robot_hash != robot_hash) return refused(fmt::format("was planned for a payload; {}", kOtherPayload));
  if (!planned->rest_to_rest) return refused("does not go from rest to rest");
  if (planned->rows.back().time > kLongestMotion) {
    return refused(
        fmt::format("takes {:.6g} s, and an executor runs at most {:g} s", planned->rows.back().time, kLongestMotion));
  }
  return std::nullopt;
}

}  // namespace fjr
