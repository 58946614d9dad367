// Request document -> wire.
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "common/input_error.h"
#include "common/strict_yaml.h"
#include "planner/dds/text.h"
#include "planner/dds/wire_request.h"
#include "planner/problem/objective_terms.h"
#include "planner/protocol/document.h"

namespace fjr::dds {
namespace {

static_assert(static_cast<int>(Action::kExecute) == fjr_msg_ACTION_EXECUTE);

void set_pair(const YamlNode& node, std::string_view unit, double (&to)[2]) {
  const Pair<double> pair = node.pair(unit);
  std::copy(pair.begin(), pair.end(), to);
}

void set_optional(const YamlNode& map, std::string_view key, std::string_view unit, bool& given, double (&to)[2]) {
  const auto node = map.find(key);
  given = node.has_value();
  if (given) set_pair(*node, unit, to);
}

void set_optional(const YamlNode& map, std::string_view key, std::string_view unit, bool& given, double& to) {
  const auto node = map.find(key);
  given = node.has_value();
  if (given) to = node->number(unit);
}

void encode_start(const YamlNode& root, fjr_msg_StartState& start) {
  const auto node = root.find("start");
  start.given = node.has_value();
  if (!start.given) return;
  node->allow_keys({"q", "dq", "theta", "dtheta"});
  set_pair(node->at("q"), "rad", start.q);
  set_optional(*node, "dq", "rad/s", start.has_dq, start.dq);
  set_optional(*node, "theta", "rad", start.has_theta, start.theta);
  set_optional(*node, "dtheta", "rad/s", start.has_dtheta, start.dtheta);
}

void encode_goal_joints(const YamlNode& q, fjr_msg_GoalState& goal) {
  const std::vector<YamlNode> items = q.items();
  if (items.size() != kJoints) (void)q.pair("rad");  // refuses, saying what is expected
  for (std::size_t j = 0; j < kJoints; ++j) {
    goal.q_free[j] = items[j].says("free");
    if (!goal.q_free[j]) goal.q[j] = items[j].number("rad");
  }
}

void encode_goal_tip(const YamlNode& node, fjr_msg_GoalState& goal) {
  goal.kind = fjr_msg_GOAL_TIP;
  set_pair(node.at("tip"), "m", goal.tip);
  set_optional(node, "tip_velocity", "m/s", goal.has_tip_velocity, goal.tip_velocity);
  const auto elbow = node.find("elbow");
  if (!elbow || elbow->says("any")) return;
  if (elbow->says("left")) {
    goal.elbow = fjr_msg_ELBOW_LEFT;
  } else if (elbow->says("right")) {
    goal.elbow = fjr_msg_ELBOW_RIGHT;
  } else {
    elbow->fail("must be any, left or right");
  }
}

void encode_goal(const YamlNode& node, fjr_msg_PlanRequest2& message) {
  fjr_msg_GoalState& goal = message.request.goal;
  node.allow_keys({"q", "dq", "theta", "dtheta", "tip", "elbow", "tip_velocity"});
  if (node.find("tip")) {
    if (const auto q = node.find("q")) q->fail("give either q or tip");
    encode_goal_tip(node, goal);
  } else {
    for (const std::string_view key : {"elbow", "tip_velocity"}) {
      if (const auto given = node.find(key)) given->fail("goes with goal.tip; with goal.q give dq");
    }
    encode_goal_joints(node.at("q"), goal);
  }
  const auto dq = node.find("dq");
  message.goal_dq_free = dq && dq->says("free");
  if (!message.goal_dq_free) set_optional(node, "dq", "rad/s", goal.has_dq, goal.dq);
  set_optional(node, "theta", "rad", goal.has_theta, goal.theta);
  set_optional(node, "dtheta", "rad/s", goal.has_dtheta, goal.dtheta);
}

void encode_duration(const YamlNode& root, fjr_msg_DurationRange& duration) {
  const auto node = root.find("duration");
  if (!node || node->says("free")) return;
  if (node->is_scalar()) {
    duration.has_min = duration.has_max = true;
    duration.min = duration.max = node->number("s");
    return;
  }
  if (!node->is_map()) node->fail("must be a number of seconds, free, or {min, max}");
  node->allow_keys({"min", "max"});
  set_optional(*node, "min", "s", duration.has_min, duration.min);
  set_optional(*node, "max", "s", duration.has_max, duration.max);
}

std::uint8_t preset_of(const YamlNode& node) {
  if (node.says("fastest")) return fjr_msg_OBJECTIVE_FASTEST;
  if (node.says("gentle")) return fjr_msg_OBJECTIVE_GENTLE;
  if (node.says("efficient")) return fjr_msg_OBJECTIVE_EFFICIENT;
  node.fail(shown(node.text()) + " is not a preset (fastest, gentle, efficient)");
}

// Where the wire has a term's weight.
double& weight_of(fjr_msg_PlanRequest2& message, std::string_view term) {
  fjr_msg_ObjectiveTerms& objective = message.request.objective;
  if (term == "time") return objective.time;
  if (term == "effort") return objective.effort;
  if (term == "torque_rate") return objective.torque_rate;
  if (term == "link_acceleration") return objective.link_acceleration;
  if (term == "link_jerk") return objective.link_jerk;
  if (term == "energy") return objective.energy;
  if (term == "copper") return message.copper;
  if (term == "peak_torque") return message.peak_torque;
  if (term == "tip_speed") return message.tip_speed;
  throw std::logic_error("the wire has no weight for " + std::string(term));
}

void encode_objective(const YamlNode& root, fjr_msg_PlanRequest2& message) {
  fjr_msg_ObjectiveTerms& objective = message.request.objective;
  const auto node = root.find("objective");
  if (!node) return;
  if (node->is_scalar()) {
    objective.preset = preset_of(*node);
    return;
  }
  objective.preset = fjr_msg_OBJECTIVE_WEIGHTS;
  std::vector<std::string_view> names;
  for (const TermInfo& term : Terms::infos) names.push_back(term.name);
  node->allow_keys(names);
  for (const TermInfo& term : Terms::infos) {
    if (const auto given = node->find(term.name)) weight_of(message, term.name) = given->number("1");
  }
}

void refuse_long_list(const YamlNode& list, std::size_t count, std::size_t most) {
  if (count > most) list.fail(std::to_string(count) + " entries, above the " + std::to_string(most) + " allowed");
}

// The one via point that is the release, if any is said to be.
void encode_release(const YamlNode& via, std::size_t index, fjr_msg_PlanRequest2& message) {
  const auto release = via.find("release");
  if (!release || release->says("false")) return;
  if (!release->says("true")) release->fail("must be true or false");
  if (message.has_release) release->fail("is said of another via point already");
  message.has_release = true;
  message.release = static_cast<std::uint32_t>(index);
}

std::vector<fjr_msg_ViaPoint> encode_vias(const YamlNode& root, fjr_msg_PlanRequest2& message) {
  std::vector<fjr_msg_ViaPoint> vias;
  const auto list = root.find("via");
  if (!list) return vias;
  const std::vector<YamlNode> items = list->items();
  refuse_long_list(*list, items.size(), fjr_msg_MAX_VIAS);
  for (const YamlNode& item : items) {
    item.allow_keys({"time", "q", "dq", "release"});
    encode_release(item, vias.size(), message);
    fjr_msg_ViaPoint via{};
    set_optional(item, "time", "s", via.has_time, via.time);
    set_pair(item.at("q"), "rad", via.q);
    set_optional(item, "dq", "rad/s", via.has_dq, via.dq);
    vias.push_back(via);
  }
  return vias;
}

std::vector<fjr_msg_Disc> encode_obstacles(const YamlNode& root) {
  std::vector<fjr_msg_Disc> discs;
  const auto list = root.find("obstacles");
  if (!list) return discs;
  const std::vector<YamlNode> items = list->items();
  refuse_long_list(*list, items.size(), fjr_msg_MAX_OBSTACLES);
  for (const YamlNode& item : items) {
    item.allow_keys({"center", "radius", "margin"});
    fjr_msg_Disc disc{};
    set_pair(item.at("center"), "m", disc.center);
    disc.radius = item.at("radius").number("m");
    if (const auto margin = item.find("margin")) disc.margin = margin->number("m");
    discs.push_back(disc);
  }
  return discs;
}

void encode_tip_segment(const YamlNode& node, fjr_msg_TipPath& tip) {
  set_pair(node.at("from"), "m", tip.from);
  set_pair(node.at("to"), "m", tip.to);
  tip.tolerance = node.at("tolerance").number("m");
}

void encode_tip(const YamlNode& root, fjr_msg_TipPath& tip) {
  const auto node = root.find("tip");
  if (!node) return;
  node->allow_keys({"box", "line", "arc"});
  const auto has = [&](std::string_view kind) { return node->find(kind) ? 1 : 0; };
  if (has("box") + has("line") + has("arc") != 1) node->fail("needs one of box, line, arc, and only one");
  if (const auto box = node->find("box")) {
    const std::vector<YamlNode> corners = box->items();
    if (corners.size() != 2) box->fail("must be two corners");
    tip.kind = fjr_msg_TIP_BOX;
    set_pair(corners[0], "m", tip.lower);
    set_pair(corners[1], "m", tip.upper);
  } else if (const auto line = node->find("line")) {
    line->allow_keys({"from", "to", "tolerance"});
    tip.kind = fjr_msg_TIP_LINE;
    encode_tip_segment(*line, tip);
  } else {
    const YamlNode arc = node->at("arc");
    arc.allow_keys({"center", "from", "to", "tolerance", "way"});
    if (const auto way = arc.find("way"); way && !way->says("short")) {
      way->fail("only short can be said to the service, which is of an older version; `fjr plan` plans it");
    }
    tip.kind = fjr_msg_TIP_ARC;
    set_pair(arc.at("center"), "m", tip.center);
    encode_tip_segment(arc, tip);
  }
}

void encode_limits(const YamlNode& root, fjr_msg_TightenedLimits& limits) {
  const auto node = root.find("limits");
  if (!node) return;
  node->allow_keys({"torque", "torque_rate", "motor_velocity", "link_position", "spring_deflection", "tip_speed"});
  set_optional(*node, "torque", "N m", limits.has_torque, limits.torque);
  set_optional(*node, "torque_rate", "N m/s", limits.has_torque_rate, limits.torque_rate);
  set_optional(*node, "motor_velocity", "rad/s", limits.has_motor_velocity, limits.motor_velocity);
  set_optional(*node, "link_position", "rad", limits.has_link_position, limits.link_position);
  set_optional(*node, "spring_deflection", "rad", limits.has_spring_deflection, limits.spring_deflection);
  set_optional(*node, "tip_speed", "m/s", limits.has_tip_speed, limits.tip_speed);
}

void encode_payload(const YamlNode& root, fjr_msg_TipPayload& payload) {
  const auto node = root.find("payload");
  payload.given = node.has_value();
  if (!payload.given) return;
  const Payload given = read_payload(*node);
  payload.mass = given.mass;
  payload.inertia = given.inertia;
}

std::vector<fjr_msg_Posture> encode_path(const YamlNode& root, fjr_msg_JointPath& path) {
  std::vector<fjr_msg_Posture> postures;
  const auto node = root.find("path");
  path.given = node.has_value();
  if (!node) return postures;
  node->allow_keys({"points", "tolerance"});
  path.tolerance = node->at("tolerance").number("rad");
  const auto points = node->find("points");
  if (!points) return postures;
  const std::vector<YamlNode> items = points->items();
  refuse_long_list(*points, items.size(), fjr_msg_MAX_PATH_POINTS);
  for (const YamlNode& item : items) set_pair(item, "rad", postures.emplace_back().q);
  return postures;
}

void encode_motion(const YamlNode& root, WireRequest& wire) {
  root.allow_keys({"robot", "start", "goal", "duration", "objective", "via", "obstacles", "tip", "path", "limits",
                   "sample_period", "seed", "payload"});
  fjr_msg_PlanRequest& message = wire.message.request;
  encode_start(root, message.start);
  encode_goal(root.at("goal"), wire.message);
  encode_duration(root, message.duration);
  encode_objective(root, wire.message);
  wire.via = encode_vias(root, wire.message);
  wire.obstacles = encode_obstacles(root);
  encode_tip(root, message.tip);
  encode_limits(root, message.limits);
  encode_payload(root, message.payload);
  wire.path = encode_path(root, wire.message.path);
  set_optional(root, "sample_period", "s", message.has_sample_period, message.sample_period);
  const auto seed = root.find("seed");
  message.has_seed = seed.has_value();
  if (seed) message.seed = seed->whole_number();
}

// The message's list is the vector's, which has to outlive it.
template <class T, class Sequence>
void lend(std::vector<T>& list, Sequence& to) {
  to._length = to._maximum = static_cast<std::uint32_t>(list.size());
  to._buffer = list.data();
}

// What every kind of request has, apart from the motion.
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
  if (order.action == Action::kExecute) return message;
  const std::string document = without_robot(order.yaml, order.name);
  if (document.size() > fjr_msg_MAX_DOCUMENT) {
    throw InputError(order.name, "", fmt::format("larger than {} bytes without comments", fjr_msg_MAX_DOCUMENT));
  }
  set_text(message.document, document);
  return message;
}

// The document is passed on as it came, whatever is wrong with it: the other one answers.
fjr_msg_RelayedRequest encode(const Relayed& relayed) {
  fjr_msg_RelayedRequest message{};
  encode_terms(relayed.order, message.asked);
  message.asked.start_within = relayed.order.start_within;
  set_text(message.asked.document, relayed.order.yaml);
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
  if (order.action == Action::kExecute) return wire;
  encode_motion(YamlNode::parse(order.yaml, order.name), wire);
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
