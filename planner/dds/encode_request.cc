// Converts requests to wire messages.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/input_error.h"
#include "common/strict_yaml.h"
#include "planner/dds/list.h"
#include "planner/dds/text.h"
#include "planner/dds/wire_request.h"
#include "planner/problem/objective_terms.h"
#include "planner/protocol/document.h"
#include "planner/request/request.h"
#include "planner/request/request_keys.h"

namespace fjr::dds {
namespace {

static_assert(static_cast<int>(Action::kExecute) == fjr_msg_ACTION_EXECUTE);
static_assert(static_cast<int>(Action::kRepeat) == fjr_msg_ACTION_REPEAT);

void set_optional(const std::optional<Joints<double>>& pair, bool& given, double (&to)[2]) {
  given = pair.has_value();
  if (given) set_pair(to, *pair);
}

template <class T>
void set_optional(const std::optional<T>& value, bool& given, T& to) {
  given = value.has_value();
  if (given) to = *value;
}

[[noreturn]] void refuse(const Request& request, const std::string& field, const std::string& problem) {
  throw InputError(request.source, field, problem);
}

void encode_start(const Request& request, fjr_msg_StartState& start) {
  start.given = request.start.has_value();
  if (!start.given) return;
  set_pair(start.q, request.start->q);
  set_optional(request.start->dq, start.has_dq, start.dq);
  set_optional(request.start->theta, start.has_theta, start.theta);
  set_optional(request.start->dtheta, start.has_dtheta, start.dtheta);
}

void encode_goal(const RequestedGoal& asked, fjr_msg_PlanRequest2& message) {
  fjr_msg_GoalState& goal = message.request.goal;
  if (const auto* tip = std::get_if<TipGoal>(&asked)) {
    goal.kind = fjr_msg_GOAL_TIP;
    set_pair(goal.tip, tip->tip);
    set_optional(tip->velocity, goal.has_tip_velocity, goal.tip_velocity);
    goal.elbow = static_cast<std::uint8_t>(tip->elbow);
    return;
  }
  const auto& [q, arrival] = std::get<JointGoal>(asked);
  for (std::size_t j = 0; j < kJoints; ++j) {
    goal.q_free[j] = !q[j];
    goal.q[j] = q[j].value_or(0);
  }
  message.goal_dq_free = std::holds_alternative<AnyVelocity>(arrival);
  const auto* moving = std::get_if<Moving>(&arrival);
  goal.has_dq = moving != nullptr;
  if (moving == nullptr) return;
  set_pair(goal.dq, moving->dq);
  set_optional(moving->theta, goal.has_theta, goal.theta);
  set_optional(moving->dtheta, goal.has_dtheta, goal.dtheta);
}

void encode_duration(const RequestedDuration& asked, fjr_msg_DurationRange& duration) {
  if (const auto* fixed = std::get_if<double>(&asked)) {
    duration = {true, *fixed, true, *fixed};
    return;
  }
  const auto& [min, max] = std::get<FreeDuration>(asked);
  set_optional(min, duration.has_min, duration.min);
  set_optional(max, duration.has_max, duration.max);
}

void encode_objective(const Request& request, fjr_msg_PlanRequest2& message) {
  if (!request.objective) return;
  fjr_msg_ObjectiveTerms& objective = message.request.objective;
  if (const auto* preset = std::get_if<Preset>(&*request.objective)) {
    constexpr std::array<std::uint8_t, 3> kPresets{fjr_msg_OBJECTIVE_FASTEST, fjr_msg_OBJECTIVE_GENTLE,
                                                   fjr_msg_OBJECTIVE_EFFICIENT};
    objective.preset = kPresets[static_cast<std::size_t>(*preset)];
    return;
  }
  objective.preset = fjr_msg_OBJECTIVE_WEIGHTS;
  const auto& weights = std::get<Weights>(*request.objective);
  for (const TermInfo& term : Terms::infos) {
    const double weight = weights.*term.weight;
    if (double* const place = weight_in(message, term.name)) {
      *place = weight;
    } else if (weight != 0) {
      refuse(request, fmt::format("objective.{}", term.name), "cannot be said by this type of request");
    }
  }
}

void refuse_long_list(const Request& request, const std::string& field, std::size_t count, std::size_t most) {
  if (count > most) refuse(request, field, fmt::format("{} entries, above the {} allowed", count, most));
}

std::vector<fjr_msg_ViaPoint> encode_vias(const Request& request, fjr_msg_PlanRequest2& message) {
  std::vector<fjr_msg_ViaPoint> vias;
  const auto* all = std::get_if<std::vector<RequestedVia>>(&request.way);
  if (all == nullptr) return vias;
  refuse_long_list(request, "via", all->size(), fjr_msg_MAX_VIAS);
  for (const RequestedVia& asked : *all) {
    if (asked.release) {
      const std::string field = fmt::format("via[{}].release", vias.size());
      if (message.has_release) refuse(request, field, "is said of another via point already");
      message.has_release = true;
      message.release = static_cast<std::uint32_t>(vias.size());
    }
    fjr_msg_ViaPoint via{};
    set_optional(asked.time, via.has_time, via.time);
    set_pair(via.q, asked.q);
    set_optional(asked.dq, via.has_dq, via.dq);
    vias.push_back(via);
  }
  return vias;
}

std::vector<fjr_msg_Disc> encode_obstacles(const Request& request) {
  refuse_long_list(request, "obstacles", request.obstacles.discs.size(), fjr_msg_MAX_OBSTACLES);
  std::vector<fjr_msg_Disc> discs;
  for (const Disc& asked : request.obstacles.discs) {
    fjr_msg_Disc disc{};
    set_pair(disc.center, asked.center);
    disc.radius = asked.radius;
    disc.margin = asked.margin;
    discs.push_back(disc);
  }
  return discs;
}

template <class Curve>
void encode_curve(const Curve& curve, fjr_msg_TipPath& tip) {
  set_pair(tip.from, curve.from);
  set_pair(tip.to, curve.to);
  tip.tolerance = curve.tolerance;
}

// Parts of a request that messages to earlier services cannot express.
constexpr const char* kForNewServices =
    "cannot be said to the service, which is of an older version; `fjr plan` plans it";

void encode_tip(const Request& request, fjr_msg_TipPath& tip) {
  if (!request.tip) return;
  const auto [box, line, arc] = by_kind(*request.tip);
  if (box) {
    tip.kind = fjr_msg_TIP_BOX;
    set_pair(tip.lower, box->lower);
    set_pair(tip.upper, box->upper);
  } else if (line) {
    tip.kind = fjr_msg_TIP_LINE;
    encode_curve(*line, tip);
  } else if (arc) {
    if (arc->way != ArcWay::kShort) refuse(request, "tip.arc.way", kForNewServices);
    tip.kind = fjr_msg_TIP_ARC;
    set_pair(tip.center, arc->center);
    encode_curve(*arc, tip);
  }
}

// An infinite limit means that none was given.
void set_limit(const Joints<double>& limit, bool& given, double (&to)[2]) {
  given = std::isfinite(limit[0]);
  if (given) set_pair(to, limit);
}

void encode_limits(const Request& request, fjr_msg_TightenedLimits& limits) {
  const Limits& asked = request.limits;
  for (const QuantityInfo& quantity : Quantities::infos) {
    const bool of_one_joint = std::isfinite(quantity.in(asked, 0)) != std::isfinite(quantity.in(asked, kJoints - 1));
    if (is_limited(quantity, asked) && (!quantity.of_first_version || of_one_joint)) {
      refuse(request, fmt::format("limits.{}", quantity.name), kForNewServices);
    }
  }
  set_limit(asked.torque, limits.has_torque, limits.torque);
  set_limit(asked.torque_rate, limits.has_torque_rate, limits.torque_rate);
  set_limit(asked.motor_velocity, limits.has_motor_velocity, limits.motor_velocity);
  set_limit(asked.link_position, limits.has_link_position, limits.link_position);
  set_limit(asked.spring_deflection, limits.has_spring_deflection, limits.spring_deflection);
  limits.has_tip_speed = std::isfinite(asked.tip_speed);
  if (limits.has_tip_speed) limits.tip_speed = asked.tip_speed;
}

std::vector<fjr_msg_Posture> encode_path(const Request& request, fjr_msg_JointPath& path) {
  std::vector<fjr_msg_Posture> postures;
  const auto* asked = std::get_if<RequestedPath>(&request.way);
  path.given = asked != nullptr;
  if (!path.given) return postures;
  path.tolerance = asked->tolerance;
  refuse_long_list(request, "path.points", asked->points.size(), fjr_msg_MAX_PATH_POINTS);
  for (const Joints<double>& point : asked->points) set_pair(postures.emplace_back().q, point);
  return postures;
}

// A key that came after the older types of request, which have no place for it.
void refuse_newer_keys(const Request& request) {
  constexpr std::array kOfOlderTypes{"robot", "start", "goal",   "duration",      "objective", "via",    "obstacles",
                                     "tip",   "path",  "limits", "sample_period", "seed",      "payload"};
  for (const std::string& key : said_keys(request)) {
    if (std::find(kOfOlderTypes.begin(), kOfOlderTypes.end(), key) == kOfOlderTypes.end()) {
      refuse(request, key, kForNewServices);
    }
  }
}

void encode_motion(const Request& request, WireRequest& wire) {
  refuse_newer_keys(request);
  fjr_msg_PlanRequest& message = wire.message.request;
  encode_start(request, message.start);
  encode_goal(request.goal, wire.message);
  encode_duration(request.duration, message.duration);
  encode_objective(request, wire.message);
  wire.via = encode_vias(request, wire.message);
  wire.obstacles = encode_obstacles(request);
  encode_tip(request, message.tip);
  encode_limits(request, message.limits);
  message.payload.given = request.payload.has_value();
  if (request.payload) {
    message.payload.mass = request.payload->mass;
    message.payload.inertia = request.payload->inertia;
  }
  wire.path = encode_path(request, wire.message.path);
  set_optional(request.sample_period, message.has_sample_period, message.sample_period);
  message.has_seed = request.seed.has_value();
  if (request.seed) message.seed = *request.seed;
}

// The message's list points to the elements of the vector, which must outlive it.
template <class T, class Sequence>
void lend(std::vector<T>& list, Sequence& to) {
  to._length = to._maximum = static_cast<std::uint32_t>(list.size());
  to._buffer = list.data();
}

// Encodes the fields that all kinds of requests have, apart from the motion.
template <class Message>
void encode_terms(const Order& order, Message& message) {
  message.id = encode(order.id);
  message.action = static_cast<std::uint8_t>(order.action);
  message.trajectory_id = encode(order.trajectory_id);
  message.priority = order.priority;
  message.budget = order.budget;
  set_text(message.name, order.name);
  set_text(message.robot_id, order.robot_id);
  set_text(message.robot_hash, order.robot_hash);
}

}  // namespace

fjr_msg_RequestId encode(const RequestId& id) {
  fjr_msg_RequestId wire{};
  std::copy(id.client.begin(), id.client.end(), wire.client);
  wire.number = id.number;
  return wire;
}

fjr_msg_MotionRequest encode(const Order& order) {
  fjr_msg_MotionRequest message{};
  encode_terms(order, message);
  message.start_within = order.start_within;
  if (of_earlier_plan(order.action)) return message;
  const std::string document = without_robot(order.document, order.name);
  if (document.size() > fjr_msg_MAX_DOCUMENT) {
    throw InputError(order.name, "", fmt::format("larger than {} bytes without comments", fjr_msg_MAX_DOCUMENT));
  }
  set_text(message.document, document);
  return message;
}

// The document is relayed unchanged, even if it is invalid; the instance that answers will refuse it.
fjr_msg_RelayedRequest encode(const Relayed& relayed) {
  fjr_msg_RelayedRequest message{};
  encode_terms(relayed.order, message.asked);
  message.asked.start_within = relayed.order.start_within;
  const Order& order = relayed.order;
  const bool as_numbers = order.document.empty() && order.motion;
  set_text(message.asked.document, as_numbers ? format_request(*order.motion) : order.document);
  if (relayed.order.refusal) {
    message.reason = static_cast<std::uint8_t>(relayed.order.refusal->reason);
    set_text(message.field, relayed.order.refusal->field);
    set_text(message.sentence, relayed.order.refusal->sentence);
  }
  std::copy(relayed.order.origin.begin(), relayed.order.origin.end(), message.participant);
  message.silence = relayed.silence;
  message.cancelled = relayed.cancelled;
  return message;
}

WireRequest encode_plan_request(const Order& order) {
  WireRequest wire;
  fjr_msg_PlanRequest& message = wire.message.request;
  encode_terms(order, message);
  if (of_earlier_plan(order.action)) return wire;
  encode_motion(read_request(YamlNode::parse(order.document, order.name)), wire);
  lend(wire.via, message.via);
  lend(wire.obstacles, message.obstacles);
  lend(wire.path, wire.message.path.points);
  return wire;
}

bool fits_plan_request(const fjr_msg_PlanRequest2& message) {
  return !message.goal_dq_free && !message.has_release && !message.path.given && message.copper == 0 &&
         message.peak_torque == 0 && message.tip_speed == 0;
}

}  // namespace fjr::dds
