// Wire -> request document.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "planner/dds/text.h"
#include "planner/dds/wire_request.h"

namespace fjr::dds {
namespace {

// Writes a YAML flow map; the first number that is not finite and the first unknown choice are remembered by name.
class Document {
 public:
  void number(std::string_view name, double value) { add(name, checked(name, value)); }
  void pair(std::string_view name, const double (&value)[2]) { add(name, pair_text(name, value)); }
  void optional(std::string_view name, bool given, double value) {
    if (given) number(name, value);
  }
  void optional(std::string_view name, bool given, const double (&value)[2]) {
    if (given) pair(name, value);
  }
  void word(std::string_view name, std::string_view text) { add(name, text); }

  void open(std::string_view name) {
    separate();
    fmt::format_to(std::back_inserter(text_), "{}: {{", name);
    path_.emplace_back(name);
    first_ = true;
  }
  void close() {
    text_ += '}';
    path_.pop_back();
    first_ = false;
  }

  // The word for a choice; an unknown one is refused.
  std::string_view choice(std::string_view name, std::uint8_t value, std::initializer_list<std::string_view> words) {
    if (value < words.size()) return *(words.begin() + value);
    refuse(name, fmt::format("{} is not one of 0 to {}", value, words.size() - 1));
    return "unknown";
  }

  void refuse(std::string_view name, std::string sentence) {
    if (refusal_) return;
    const std::string within = fmt::format("{}", fmt::join(path_, "."));
    const std::string field = within.empty() ? std::string(name) : fmt::format("{}.{}", within, name);
    refusal_ = Refusal{Reason::kBadInput, field, std::move(sentence)};
  }

  // Entries of a list stand for themselves, without a name.
  void bare_pair(std::string_view name, const double (&value)[2]) {
    separate();
    text_ += pair_text(name, value);
  }
  void open_item(std::string_view list, std::size_t index) {
    separate();
    text_ += '{';
    path_.push_back(indexed(list, index));
    first_ = true;
  }
  void open_list(std::string_view name) {
    separate();
    fmt::format_to(std::back_inserter(text_), "{}: [", name);
    first_ = true;
  }
  void close_list() {
    text_ += ']';
    first_ = false;
  }

  std::string checked(std::string_view name, double value) {
    if (!std::isfinite(value)) refuse(name, fmt::format("{} is not finite", value));
    return fmt::format("{}", value);  // the shortest text that reads back to the same bits
  }

  std::string text() const { return "{" + text_ + "}"; }
  const std::optional<Refusal>& refusal() const { return refusal_; }

 private:
  static std::string indexed(std::string_view name, std::size_t index) { return fmt::format("{}[{}]", name, index); }

  std::string pair_text(std::string_view name, const double (&value)[2]) {
    return fmt::format("[{}, {}]", checked(indexed(name, 0), value[0]), checked(indexed(name, 1), value[1]));
  }
  void add(std::string_view name, std::string_view value) {
    separate();
    fmt::format_to(std::back_inserter(text_), "{}: {}", name, value);
  }
  void separate() {
    if (!first_) text_ += ", ";
    first_ = false;
  }

  std::string text_;
  std::vector<std::string> path_;
  bool first_ = true;
  std::optional<Refusal> refusal_;
};

void write_start(Document& document, const fjr_msg_StartState& start) {
  if (!start.given) return;
  document.open("start");
  document.pair("q", start.q);
  document.optional("dq", start.has_dq, start.dq);
  document.optional("theta", start.has_theta, start.theta);
  document.optional("dtheta", start.has_dtheta, start.dtheta);
  document.close();
}

void write_goal_joints(Document& document, const fjr_msg_GoalState& goal) {
  std::array<std::string, kJoints> q;
  for (std::size_t j = 0; j < kJoints; ++j) {
    q[j] = goal.q_free[j] ? "free" : document.checked(fmt::format("q[{}]", j), goal.q[j]);
  }
  document.word("q", fmt::format("[{}, {}]", q[0], q[1]));
}

void write_goal(Document& document, const fjr_msg_GoalState& goal, bool dq_free) {
  document.open("goal");
  const std::string_view kind = document.choice("kind", goal.kind, {"q", "tip"});
  if (kind == "tip") {
    document.pair("tip", goal.tip);
    document.word("elbow", document.choice("elbow", goal.elbow, {"any", "left", "right"}));
    document.optional("tip_velocity", goal.has_tip_velocity, goal.tip_velocity);
  } else {
    write_goal_joints(document, goal);
  }
  if (dq_free) document.word("dq", "free");
  document.optional("dq", goal.has_dq && !dq_free, goal.dq);
  document.optional("theta", goal.has_theta, goal.theta);
  document.optional("dtheta", goal.has_dtheta, goal.dtheta);
  document.close();
}

void write_duration(Document& document, const fjr_msg_DurationRange& duration) {
  if (!duration.has_min && !duration.has_max) return;
  if (duration.has_min && duration.has_max && duration.min == duration.max) {
    document.number("duration", duration.min);
    return;
  }
  document.open("duration");
  document.optional("min", duration.has_min, duration.min);
  document.optional("max", duration.has_max, duration.max);
  document.close();
}

void write_objective(Document& document, const fjr_msg_PlanRequest2& message) {
  const fjr_msg_ObjectiveTerms& objective = message.request.objective;
  const std::string_view preset =
      document.choice("objective", objective.preset, {"default", "fastest", "gentle", "efficient", "weights"});
  if (preset == "default") return;
  if (preset != "weights") {
    document.word("objective", preset);
    return;
  }
  document.open("objective");
  document.optional("time", objective.time != 0, objective.time);
  document.optional("effort", objective.effort != 0, objective.effort);
  document.optional("torque_rate", objective.torque_rate != 0, objective.torque_rate);
  document.optional("link_acceleration", objective.link_acceleration != 0, objective.link_acceleration);
  document.optional("link_jerk", objective.link_jerk != 0, objective.link_jerk);
  document.optional("energy", objective.energy != 0, objective.energy);
  document.optional("copper", message.copper != 0, message.copper);
  document.optional("peak_torque", message.peak_torque != 0, message.peak_torque);
  document.optional("tip_speed", message.tip_speed != 0, message.tip_speed);
  document.close();
}

void write_vias(Document& document, const fjr_msg_PlanRequest2& message) {
  const dds_sequence_fjr_msg_ViaPoint& vias = message.request.via;
  if (message.has_release && message.release >= vias._length) {
    document.refuse("release", fmt::format("{} is none of the {} via points", message.release, vias._length));
  }
  if (vias._length == 0) return;
  document.open_list("via");
  for (std::uint32_t i = 0; i < vias._length; ++i) {
    const fjr_msg_ViaPoint& via = vias._buffer[i];
    document.open_item("via", i);
    document.optional("time", via.has_time, via.time);
    document.pair("q", via.q);
    document.optional("dq", via.has_dq, via.dq);
    if (message.has_release && message.release == i) document.word("release", "true");
    document.close();
  }
  document.close_list();
}

void write_obstacles(Document& document, const dds_sequence_fjr_msg_Disc& discs) {
  if (discs._length == 0) return;
  document.open_list("obstacles");
  for (std::uint32_t i = 0; i < discs._length; ++i) {
    const fjr_msg_Disc& disc = discs._buffer[i];
    document.open_item("obstacles", i);
    document.pair("center", disc.center);
    document.number("radius", disc.radius);
    document.number("margin", disc.margin);
    document.close();
  }
  document.close_list();
}

void write_tip_segment(Document& document, const fjr_msg_TipPath& tip) {
  document.pair("from", tip.from);
  document.pair("to", tip.to);
  document.number("tolerance", tip.tolerance);
}

void write_tip(Document& document, const fjr_msg_TipPath& tip) {
  const std::string_view kind = document.choice("tip", tip.kind, {"free", "box", "line", "arc"});
  if (kind == "free") return;
  document.open("tip");
  if (kind == "box") {
    document.open_list("box");
    document.bare_pair("box[0]", tip.lower);
    document.bare_pair("box[1]", tip.upper);
    document.close_list();
  } else {
    document.open(kind);
    if (kind == "arc") document.pair("center", tip.center);
    write_tip_segment(document, tip);
    document.close();
  }
  document.close();
}

void write_limits(Document& document, const fjr_msg_TightenedLimits& limits) {
  document.open("limits");
  document.optional("torque", limits.has_torque, limits.torque);
  document.optional("torque_rate", limits.has_torque_rate, limits.torque_rate);
  document.optional("motor_velocity", limits.has_motor_velocity, limits.motor_velocity);
  document.optional("link_position", limits.has_link_position, limits.link_position);
  document.optional("spring_deflection", limits.has_spring_deflection, limits.spring_deflection);
  document.optional("tip_speed", limits.has_tip_speed, limits.tip_speed);
  document.close();
}

void write_payload(Document& document, const fjr_msg_TipPayload& payload) {
  if (!payload.given) return;
  document.open("payload");
  document.number("mass", payload.mass);
  document.number("inertia", payload.inertia);
  document.close();
}

void write_path(Document& document, const fjr_msg_JointPath& path) {
  if (!path.given) return;
  document.open("path");
  document.open_list("points");
  for (std::uint32_t i = 0; i < path.points._length; ++i) {
    document.bare_pair(fmt::format("points[{}]", i), path.points._buffer[i].q);
  }
  document.close_list();
  document.number("tolerance", path.tolerance);
  document.close();
}

void write_motion(Document& document, const fjr_msg_PlanRequest2& extended) {
  const fjr_msg_PlanRequest& message = extended.request;
  write_start(document, message.start);
  write_goal(document, message.goal, extended.goal_dq_free);
  write_duration(document, message.duration);
  write_objective(document, extended);
  write_vias(document, extended);
  write_obstacles(document, message.obstacles);
  write_tip(document, message.tip);
  write_limits(document, message.limits);
  write_payload(document, message.payload);
  write_path(document, extended.path);
  document.optional("sample_period", message.has_sample_period, message.sample_period);
  if (message.has_seed) document.word("seed", std::to_string(message.seed));
}

std::optional<Refusal> refusal_of_time(const char* field, double time) {
  if (std::isfinite(time) && time >= 0) return std::nullopt;
  return Refusal{Reason::kBadInput, field, fmt::format("{} s must be finite and not negative", time)};
}

// What every kind of request has, apart from the motion.
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
  if (message.action > fjr_msg_ACTION_EXECUTE) {
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
  if (order.action == Action::kExecute) return order;
  Document document;
  write_motion(document, extended);
  order.yaml = document.text();
  if (!order.refusal) order.refusal = document.refusal();
  return order;
}

Order decode(const fjr_msg_MotionRequest& message) {
  Order order = decode_terms(message);
  order.start_within = message.start_within;
  if (!order.refusal) order.refusal = refusal_of_time("start_within", message.start_within);
  order.yaml = raw_text_of(message.document);
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
  relayed.silence = std::isfinite(message.silence) ? std::max(0.0, message.silence) : 0;
  relayed.cancelled = message.cancelled;
  return relayed;
}

}  // namespace fjr::dds
