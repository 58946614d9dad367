// Converts wire messages to requests.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "planner/dds/text.h"
#include "planner/dds/wire_request.h"
#include "planner/request/request_keys.h"

namespace fjr::dds {
namespace {

// [s] A longer silence is taken for this one, because silences are counted in whole nanoseconds, of which 64 bits do
// not have enough for every number.
constexpr double kLongestSilence = 86400;

// Takes numbers and choices out of a message; the first number that is not finite and the first unknown choice are
// remembered by the names that a request has for them.
class Taker {
 public:
  double number(const std::string& field, double value) {
    if (!std::isfinite(value)) refuse(field, fmt::format("{} is not finite", value));
    return value;
  }
  Joints<double> pair(const std::string& field, const double (&value)[2]) {
    return {number(field + "[0]", value[0]), number(field + "[1]", value[1])};
  }
  std::optional<double> optional(const std::string& field, bool given, double value) {
    if (!given) return std::nullopt;
    return number(field, value);
  }
  std::optional<Joints<double>> optional(const std::string& field, bool given, const double (&value)[2]) {
    if (!given) return std::nullopt;
    return pair(field, value);
  }
  // The constants of a choice are 0, 1, ...; an unknown one is taken for the first.
  std::uint8_t choice(const std::string& field, std::uint8_t value, std::uint8_t last) {
    if (value <= last) return value;
    refuse(field, fmt::format("{} is not one of 0 to {}", value, last));
    return 0;
  }

  void refuse(const std::string& field, std::string sentence) {
    if (!refusal_) refusal_ = Refusal{Reason::kBadInput, field, std::move(sentence)};
  }
  const std::optional<Refusal>& refusal() const { return refusal_; }

 private:
  std::optional<Refusal> refusal_;
};

std::optional<RequestedStart> start_of(Taker& take, const fjr_msg_StartState& start) {
  if (!start.given) return std::nullopt;
  return RequestedStart{take.pair("start.q", start.q), take.optional("start.dq", start.has_dq, start.dq),
                        take.optional("start.theta", start.has_theta, start.theta),
                        take.optional("start.dtheta", start.has_dtheta, start.dtheta)};
}

AnglesOrFree goal_angles_of(Taker& take, const fjr_msg_GoalState& goal) {
  AnglesOrFree q;
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!goal.q_free[j]) q[j] = take.number(fmt::format("goal.q[{}]", j), goal.q[j]);
  }
  return q;
}

GoalByKey goal_keys_of(Taker& take, const fjr_msg_GoalState& wire, bool dq_free) {
  GoalByKey goal;
  if (take.choice("goal.kind", wire.kind, fjr_msg_GOAL_TIP) == fjr_msg_GOAL_TIP) {
    constexpr std::array kElbows{Elbow::kAny, Elbow::kLeft, Elbow::kRight};
    goal.tip = take.pair("goal.tip", wire.tip);
    goal.elbow = kElbows[take.choice("goal.elbow", wire.elbow, kElbows.size() - 1)];
    goal.tip_velocity = take.optional("goal.tip_velocity", wire.has_tip_velocity, wire.tip_velocity);
  } else {
    goal.q = goal_angles_of(take, wire);
  }
  if (dq_free) {
    goal.dq = AnyVelocity{};
  } else if (wire.has_dq) {
    goal.dq = take.pair("goal.dq", wire.dq);
  }
  goal.theta = take.optional("goal.theta", wire.has_theta, wire.theta);
  goal.dtheta = take.optional("goal.dtheta", wire.has_dtheta, wire.dtheta);
  return goal;
}

RequestedDuration duration_of(Taker& take, const fjr_msg_DurationRange& wire) {
  if (wire.has_min && wire.has_max && wire.min == wire.max) return take.number("duration", wire.min);
  return FreeDuration{take.optional("duration.min", wire.has_min, wire.min),
                      take.optional("duration.max", wire.has_max, wire.max)};
}

std::optional<RequestedObjective> objective_of(Taker& take, const fjr_msg_PlanRequest2& message) {
  const fjr_msg_ObjectiveTerms& wire = message.request.objective;
  switch (take.choice("objective", wire.preset, fjr_msg_OBJECTIVE_WEIGHTS)) {
    case fjr_msg_OBJECTIVE_FASTEST:
      return RequestedObjective{Preset::kFastest};
    case fjr_msg_OBJECTIVE_GENTLE:
      return RequestedObjective{Preset::kGentle};
    case fjr_msg_OBJECTIVE_EFFICIENT:
      return RequestedObjective{Preset::kEfficient};
    case fjr_msg_OBJECTIVE_WEIGHTS:
      break;
    default:
      return std::nullopt;
  }
  Weights weights;
  for (const TermInfo& term : Terms::infos) {
    const auto* weight = weight_in(message, term.name);
    if (weight) weights.*term.weight = take.number(fmt::format("objective.{}", term.name), *weight);
  }
  return weights;
}

std::vector<RequestedVia> vias_of(Taker& take, const fjr_msg_PlanRequest2& message) {
  const dds_sequence_fjr_msg_ViaPoint& wire = message.request.via;
  if (message.has_release && message.release >= wire._length) {
    take.refuse("release", fmt::format("{} is none of the {} via points", message.release, wire._length));
  }
  std::vector<RequestedVia> vias;
  for (std::uint32_t i = 0; i < wire._length; ++i) {
    const fjr_msg_ViaPoint& via = wire._buffer[i];
    const std::string field = fmt::format("via[{}].", i);
    vias.push_back({take.optional(field + "time", via.has_time, via.time), take.pair(field + "q", via.q),
                    take.optional(field + "dq", via.has_dq, via.dq), message.has_release && message.release == i});
  }
  return vias;
}

std::vector<Disc> obstacles_of(Taker& take, const dds_sequence_fjr_msg_Disc& wire) {
  std::vector<Disc> discs;
  for (std::uint32_t i = 0; i < wire._length; ++i) {
    const fjr_msg_Disc& disc = wire._buffer[i];
    const std::string field = fmt::format("obstacles[{}].", i);
    discs.push_back({take.pair(field + "center", disc.center), take.number(field + "radius", disc.radius),
                     take.number(field + "margin", disc.margin)});
  }
  return discs;
}

std::optional<RequestedTip> tip_of(Taker& take, const fjr_msg_TipPath& wire) {
  switch (take.choice("tip", wire.kind, fjr_msg_TIP_ARC)) {
    case fjr_msg_TIP_BOX:
      return TipBox{take.pair("tip.box[0]", wire.lower), take.pair("tip.box[1]", wire.upper)};
    case fjr_msg_TIP_LINE:
      return TipLine{take.pair("tip.line.from", wire.from), take.pair("tip.line.to", wire.to),
                     take.number("tip.line.tolerance", wire.tolerance)};
    case fjr_msg_TIP_ARC:
      return TipArc{take.pair("tip.arc.center", wire.center), take.pair("tip.arc.from", wire.from),
                    take.pair("tip.arc.to", wire.to), take.number("tip.arc.tolerance", wire.tolerance)};
    default:
      return std::nullopt;
  }
}

Limits limits_of(Taker& take, const fjr_msg_TightenedLimits& wire) {
  constexpr Joints<double> kNone{kNoLimit, kNoLimit};
  Limits limits;
  limits.torque = take.optional("limits.torque", wire.has_torque, wire.torque).value_or(kNone);
  limits.torque_rate = take.optional("limits.torque_rate", wire.has_torque_rate, wire.torque_rate).value_or(kNone);
  limits.motor_velocity =
      take.optional("limits.motor_velocity", wire.has_motor_velocity, wire.motor_velocity).value_or(kNone);
  limits.link_position =
      take.optional("limits.link_position", wire.has_link_position, wire.link_position).value_or(kNone);
  limits.spring_deflection =
      take.optional("limits.spring_deflection", wire.has_spring_deflection, wire.spring_deflection).value_or(kNone);
  limits.tip_speed = take.optional("limits.tip_speed", wire.has_tip_speed, wire.tip_speed).value_or(kNoLimit);
  return limits;
}

std::optional<RequestedPath> path_of(Taker& take, const fjr_msg_JointPath& wire) {
  if (!wire.given) return std::nullopt;
  RequestedPath path;
  for (std::uint32_t i = 0; i < wire.points._length; ++i) {
    path.points.push_back(take.pair(fmt::format("path.points[{}]", i), wire.points._buffer[i].q));
  }
  path.tolerance = take.number("path.tolerance", wire.tolerance);
  return path;
}

Request motion_of(Taker& take, const fjr_msg_PlanRequest2& extended) {
  const fjr_msg_PlanRequest& message = extended.request;
  Request request;
  request.start = start_of(take, message.start);
  const GoalByKey goal = goal_keys_of(take, message.goal, extended.goal_dq_free);
  request.goal = goal_of(goal);
  request.duration = duration_of(take, message.duration);
  request.objective = objective_of(take, extended);
  std::vector<RequestedVia> vias = vias_of(take, extended);
  request.obstacles.discs = obstacles_of(take, message.obstacles);
  request.tip = tip_of(take, message.tip);
  request.limits = limits_of(take, message.limits);
  if (message.payload.given) {
    request.payload = Payload{take.number("payload.mass", message.payload.mass),
                              take.number("payload.inertia", message.payload.inertia)};
  }
  std::optional<RequestedPath> path = path_of(take, extended.path);
  const bool both = path && !vias.empty();
  request.way = path ? RequestedWay{std::move(*path)} : RequestedWay{std::move(vias)};
  request.sample_period = take.optional("sample_period", message.has_sample_period, message.sample_period);
  if (message.has_seed) request.seed = message.seed;
  // Numbers that are not finite are reported first, with the names of their fields.
  if (const auto fault = fault_of(goal)) take.refuse(fmt::format("goal.{}", fault->key), fault->sentence);
  if (both) take.refuse("path", kPathAndVia);
  return request;
}

std::optional<Refusal> refusal_of_time(const char* field, double time) {
  if (std::isfinite(time) && time >= 0) return std::nullopt;
  return Refusal{Reason::kBadInput, field, fmt::format("{} s must be finite and not negative", time)};
}

// Decodes the fields that all kinds of requests have, apart from the motion.
template <class Message>
Order decode_terms(const Message& message) {
  Order order;
  order.id = decode(message.id);
  order.name = text_of(message.name);
  order.action = static_cast<Action>(message.action);
  order.trajectory_id = decode(message.trajectory_id);
  order.priority = message.priority;
  order.budget = message.budget;
  order.robot_id = text_of(message.robot_id);
  order.robot_hash = text_of(message.robot_hash);
  order.refusal = refusal_of_time("budget", message.budget);
  if (message.action > fjr_msg_ACTION_REPEAT) {
    order.refusal =
        Refusal{Reason::kUnsupported, "action", fmt::format("{} is not supported by this version", message.action)};
  }
  return order;
}

}  // namespace

RequestId decode(const fjr_msg_RequestId& wire) {
  RequestId id;
  std::copy(std::begin(wire.client), std::end(wire.client), id.client.begin());
  id.number = wire.number;
  return id;
}

Order decode(const fjr_msg_PlanRequest2& extended) {
  Order order = decode_terms(extended.request);
  if (of_earlier_plan(order.action)) return order;
  Taker take;
  order.motion = motion_of(take, extended);
  order.motion->source = order.name;
  if (!order.refusal) order.refusal = take.refusal();
  return order;
}

Order decode(const fjr_msg_MotionRequest& message) {
  Order order = decode_terms(message);
  order.start_within = message.start_within;
  if (!order.refusal) order.refusal = refusal_of_time("start_within", message.start_within);
  order.document = raw_text_of(message.document);
  return order;
}

Order decode(const fjr_msg_PlanRequest& message) {
  fjr_msg_PlanRequest2 extended{};
  extended.request = message;
  return decode(extended);
}

Relayed decode(const fjr_msg_RelayedRequest& message) {
  Relayed relayed;
  relayed.order = decode(message.asked);
  std::copy(std::begin(message.participant), std::end(message.participant), relayed.order.origin.begin());
  if (message.reason != fjr_msg_REASON_NONE) {
    relayed.order.refusal =
        Refusal{static_cast<Reason>(message.reason), text_of(message.field), text_of(message.sentence)};
  }
  relayed.silence = std::isnan(message.silence) ? 0 : std::clamp(message.silence, 0.0, kLongestSilence);
  relayed.cancelled = message.cancelled;
  return relayed;
}

}  // namespace fjr::dds
