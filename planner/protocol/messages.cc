#include "planner/protocol/messages.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <charconv>
#include <stdexcept>

#include "planner/problem/task/task.h"

namespace fjr {

std::string client_name(const RequestId& id) { return fmt::format("{:02x}", fmt::join(id.client, "")); }

std::string text(const RequestId& id) { return fmt::format("{}-{}", client_name(id).substr(0, 12), id.number); }

RequestId new_client() {
  RequestId id;
  if (::getrandom(id.client.data(), id.client.size(), 0) != static_cast<ssize_t>(id.client.size())) {
    throw std::runtime_error("no random numbers from the system");
  }
  return id;
}

std::string to_text(const RequestId& id) { return fmt::format("{}-{}", client_name(id), id.number); }

std::optional<RequestId> request_id_from(std::string_view text) {
  constexpr std::size_t kDigits = 32;
  if (text.size() < kDigits + 2 || text[kDigits] != '-') return std::nullopt;
  const auto read = [](std::string_view digits, auto& to, int base) {
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), to, base);
    return error == std::errc() && end == digits.data() + digits.size();
  };
  RequestId id;
  for (std::size_t i = 0; i < id.client.size(); ++i) {
    if (!read(text.substr(2 * i, 2), id.client[i], 16)) return std::nullopt;
  }
  if (!read(text.substr(kDigits + 1), id.number, 10)) return std::nullopt;
  return id;
}

std::size_t size_of(const Order& order) {
  std::size_t size = sizeof(Order) + order.document.size();
  if (order.motion) {
    const Request& r = *order.motion;
    const auto* vias = std::get_if<std::vector<RequestedVia>>(&r.way);
    size += vias != nullptr ? vias->size() * sizeof(RequestedVia)
                            : std::get<RequestedPath>(r.way).points.size() * sizeof(Joints<double>);
    visit_obstacles(r.obstacles, [&](const auto& list) { size += list.size() * sizeof(list.front()); });
  }
  return size;
}

std::size_t size_of(const Reply& reply) {
  return sizeof(Reply) + reply.plan_json.capacity() + reply.rows.capacity() * sizeof(Sample) +
         reply.stops.capacity() * sizeof(StopMotion);
}

const char* name(ReplyState state) {
  switch (state) {
    case ReplyState::kAccepted:
      return "ACCEPTED";
    case ReplyState::kRejected:
      return "REJECTED";
    case ReplyState::kSolved:
      return "SOLVED";
    case ReplyState::kInfeasible:
      return "INFEASIBLE";
    case ReplyState::kFailed:
      return "FAILED";
    case ReplyState::kCancelled:
      return "CANCELLED";
    case ReplyState::kExpired:
      return "EXPIRED";
  }
  return "unknown";  // from a service of another version
}

const char* name(Reason reason) {
  switch (reason) {
    case Reason::kNone:
      return "NONE";
    case Reason::kBadInput:
      return "BAD_INPUT";
    case Reason::kQueueFull:
      return "QUEUE_FULL";
    case Reason::kWrongRobot:
      return "WRONG_ROBOT";
    case Reason::kInfeasible:
      return "INFEASIBLE";
    case Reason::kNotConverged:
      return "NOT_CONVERGED";
    case Reason::kUncertified:
      return "UNCERTIFIED";
    case Reason::kBudget:
      return "BUDGET";
    case Reason::kCancelled:
      return "CANCELLED";
    case Reason::kWorkerLost:
      return "WORKER_LOST";
    case Reason::kShuttingDown:
      return "SHUTTING_DOWN";
    case Reason::kUnsupported:
      return "UNSUPPORTED";
    case Reason::kArmNotAtRest:
      return "ARM_NOT_AT_REST";
    case Reason::kNoTrajectory:
      return "NO_TRAJECTORY";
    case Reason::kClientGone:
      return "CLIENT_GONE";
  }
  return "unknown";  // from a service of another version
}

ReplyState state_of(PlanStatus status) {
  switch (status) {
    case PlanStatus::kCertified:
      return ReplyState::kSolved;
    case PlanStatus::kBadInput:
      return ReplyState::kRejected;
    case PlanStatus::kInfeasible:
      return ReplyState::kInfeasible;
    case PlanStatus::kNotConverged:
    case PlanStatus::kUncertified:
      return ReplyState::kFailed;
    case PlanStatus::kDeadline:
      return ReplyState::kExpired;
    case PlanStatus::kCancelled:
      return ReplyState::kCancelled;
  }
  throw std::logic_error("PlanStatus out of range");
}

Reason reason_of(PlanStatus status) {
  switch (status) {
    case PlanStatus::kCertified:
      return Reason::kNone;
    case PlanStatus::kBadInput:
      return Reason::kBadInput;
    case PlanStatus::kInfeasible:
      return Reason::kInfeasible;
    case PlanStatus::kNotConverged:
      return Reason::kNotConverged;
    case PlanStatus::kUncertified:
      return Reason::kUncertified;
    case PlanStatus::kDeadline:
      return Reason::kBudget;
    case PlanStatus::kCancelled:
      return Reason::kCancelled;
  }
  throw std::logic_error("PlanStatus out of range");
}

PlanStatus status_of(const Reply& reply) {
  switch (reply.state) {
    case ReplyState::kSolved:
      return PlanStatus::kCertified;
    case ReplyState::kRejected:
      return PlanStatus::kBadInput;
    case ReplyState::kInfeasible:
      return PlanStatus::kInfeasible;
    case ReplyState::kExpired:
      return PlanStatus::kDeadline;
    case ReplyState::kCancelled:
      return PlanStatus::kCancelled;
    case ReplyState::kAccepted:
    case ReplyState::kFailed:
      break;
  }
  return reply.why.reason == Reason::kUncertified ? PlanStatus::kUncertified : PlanStatus::kNotConverged;
}

}  // namespace fjr
