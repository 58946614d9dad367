#include "planner/certificate/proof/prove.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "planner/certificate/amplification.h"
#include "planner/certificate/consistency.h"
#include "planner/certificate/limits.h"
#include "planner/certificate/proof/arm_flow.h"
#include "planner/certificate/proof/quantity_series.h"
#include "planner/certificate/proof/reach.h"
#include "planner/certificate/proof/task_reaches.h"
#include "planner/certificate/thresholds.h"
#include "planner/problem/task/task.h"

namespace fjr {
namespace {

using enclosure::Ball;
using enclosure::Polynomial;

constexpr int kBetweenQuestions = 100;  // steps between calls of stopped(), some milliseconds
constexpr std::size_t kRowOrder = 6;    // more than any polynomial quantity has between rows

Polynomial difference(const Polynomial& a, const Polynomial& b) {
  Polynomial d = a;
  for (std::size_t k = 0; k < b.size(); ++k) d[k] -= b[k];
  return d;
}

// Some quantities are computed as squares, whose limits have to be squared.
Reach reach_of(const QuantityInfo& quantity, double allowed) {
  return Reach(quantity.squared ? enclosure::square(Ball(allowed)).lower() : allowed);
}
double magnitude(const QuantityInfo& quantity, double bound) {
  return quantity.squared ? enclosure::rounded_up(std::sqrt(bound)) : bound;
}

std::string whose(const LimitName& name) {
  return name.joint > 0 ? fmt::format("{} of joint {}", name.quantity->name, name.joint) : name.quantity->name;
}

// The earliest failure among several attempts to prove something.
struct Gap {
  double time = HUGE_VAL;
  std::string reason;

  void note(double at, const std::string& what) {
    if (at >= time) return;
    time = at;
    reason = what;
  }
};

// A reach for every limit.
class LimitReaches {
 public:
  LimitReaches(const Limits& allowed) {
    for (const LimitName& name : kLimitNames) reaches_.push_back(reach_of(*name.quantity, name.in(allowed)));
  }
  Reach& operator[](std::size_t i) { return reaches_[i]; }
  double bound(std::size_t i) const { return magnitude(*kLimitNames[i].quantity, reaches_[i].bound()); }

 private:
  std::vector<Reach> reaches_;
};

class LoopProver {
 public:
  LoopProver(const Parameters& robot, const Claims& claims, bool closed, const std::function<bool()>& stopped)
      : robot_(robot),
        claims_(claims),
        stopped_(stopped),
        closed_(closed),
        link_{Reach(claims.link), Reach(claims.link)},
        link_velocity_{Reach(claims.link_velocity), Reach(claims.link_velocity)},
        motor_velocity_{Reach(claims.motor_velocity[0]), Reach(claims.motor_velocity[1])},
        feedback_{Reach(claims.feedback[0]), Reach(claims.feedback[1])},
        limits_(claims.rollout),
        task_(robot, closed ? claims.task : TaskOfMotion{}, kArmOrder,
              [&](const TaskRow& row) { return claims.task_fraction * row.scale + moved_by(robot, row, claims.link); }),
        quantities_(robot, claims.rollout, kArmOrder,
                    [](const QuantityInfo& quantity) { return quantity.in_rollout != InRollout::kOfPlan; }) {}

  void run(const Trajectory& trajectory, const std::vector<Piece>& pieces) {
    const Followed followed = follow(robot_, trajectory, pieces, [&](const ArmStep& step) { return keeps(step); });
    if (!followed.completed && gap_.reason.empty()) {
      gap_.note(followed.until,
                fmt::format("no enclosure of the motion goes on; it is known to {:.1e} rad there", followed.width));
    }
    followed_ = followed;
  }

  Proof::Loop result() const {
    Proof::Loop r;
    r.proven = followed_.completed;
    r.until = followed_.completed ? followed_.until : std::min(gap_.time, followed_.until);
    r.reason = gap_.reason;
    for (std::size_t j = 0; j < kJoints; ++j) {
      r.link[j] = link_[j].bound();
      r.link_velocity[j] = link_velocity_[j].bound();
      r.motor_velocity[j] = motor_velocity_[j].bound();
      r.feedback_torque[j] = feedback_[j].bound();
    }
    r.time_of_max_link = link_[link_[1].bound() > link_[0].bound() ? 1 : 0].time();
    r.width = followed_.width;
    r.steps = followed_.steps;
    return r;
  }
  const LimitReaches& limits() const { return limits_; }
  const TaskReaches& task() const { return task_; }

 private:
  bool keeps(const ArmStep& step) {
    if (++steps_ % kBetweenQuestions == 0 && stopped_()) {
      gap_.note(step.time, "stopped on request");
      return false;
    }
    bool kept = true;
    for (std::size_t j = 0; j < kJoints && kept; ++j) {
      kept = keeps_link(step, j) && (!closed_ || (keeps_velocities(step, j) && keeps_feedback(step, j)));
    }
    return kept && (!closed_ || (keeps_limits(step) && keeps_task(step)));
  }
  bool keeps_link(const ArmStep& step, std::size_t j) {
    const Polynomial error = difference(step.solution.near[kStateQ + j], step.plan.state.q[j]);
    if (link_[j].include(error, step.solution.length, step.time)) return true;
    return fail(link_[j], fmt::format("link {} may be", j + 1), "rad off the plan");
  }
  bool keeps_velocities(const ArmStep& step, std::size_t j) {
    const Polynomial link = difference(step.solution.near[kStateDq + j], step.plan.state.dq[j]),
                     motor = difference(step.solution.near[kStateDtheta + j], step.plan.state.dtheta[j]);
    const auto keeps = [&](Reach& reach, const Polynomial& error, const char* what) {
      if (reach.include(error, step.solution.length, step.time)) return true;
      return fail(reach, fmt::format("the velocity of {} {} may be", what, j + 1), "rad/s off the plan");
    };
    return keeps(link_velocity_[j], link, "link") && keeps(motor_velocity_[j], motor, "motor");
  }
  bool keeps_feedback(const ArmStep& step, std::size_t j) {
    const Polynomial position = difference(step.solution.near[kStateTheta + j], step.plan.state.theta[j]),
                     velocity = difference(step.solution.near[kStateDtheta + j], step.plan.state.dtheta[j]);
    Polynomial feedback;
    for (std::size_t k = 0; k < position.size(); ++k) {
      feedback.push_back(robot_.feedback.position_gain[j] * position[k] +
                         robot_.feedback.velocity_gain[j] * velocity[k]);
    }
    if (feedback_[j].include(feedback, step.solution.length, step.time)) return true;
    return fail(feedback_[j], fmt::format("feedback torque of joint {} may reach", j + 1), "N m");
  }
  bool keeps_limits(const ArmStep& step) {
    AlongState motion;
    for (std::size_t i = 0; i < kStates; ++i) {
      motion.near[i] = step.solution.near[i];
      motion.over[i] = step.solution.over[i];
    }
    const std::vector<Polynomial>& values = quantities_.along(motion);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t limit = quantities_.limits()[i];
      Reach& reach = limits_[limit];
      if (reach.include(values[i], step.solution.length, step.time)) continue;
      const LimitName& name = kLimitNames[limit];
      gap_.note(reach.time(), fmt::format("{} may reach {:.9g}, allowed {:.9g}", whose(name), limits_.bound(limit),
                                          name.in(claims_.rollout)));
      return false;
    }
    return true;
  }
  // Each step lies within one segment.
  bool keeps_task(const ArmStep& step) {
    AlongLinks links;
    for (std::size_t j = 0; j < kJoints; ++j) {
      links.near[j] = step.solution.near[kStateQ + j];
      links.over[j] = step.solution.over[kStateQ + j];
    }
    const double middle = step.time + step.solution.length.mid / 2;
    if (task_.include(links, step.solution.length, step.time, claims_.task.segment_at(middle))) return true;
    gap_.note(task_.gap().time, task_.gap().reason);
    return false;
  }
  bool fail(const Reach& reach, const std::string& what, const char* unit) {
    gap_.note(reach.time(), fmt::format("{} {:.9g} {}, allowed {:.9g}", what, reach.bound(), unit, reach.allowed()));
    return false;
  }

  const Parameters& robot_;
  const Claims& claims_;
  const std::function<bool()>& stopped_;
  bool closed_;
  long steps_ = 0;
  Joints<Reach> link_, link_velocity_, motor_velocity_, feedback_;
  LimitReaches limits_;
  TaskReaches task_;
  QuantitySeries quantities_;
  Followed followed_;
  Gap gap_;
};

// Proves the limits and the task of the published rows with their interpolation.
class RowsProver {
 public:
  RowsProver(const Parameters& robot, const Claims& claims)
      : robot_(robot),
        claims_(claims),
        limits_(claims.published),
        task_(robot, claims.task, kRowOrder, [&](const TaskRow& row) { return claims.task_fraction * row.scale; }),
        quantities_(robot, claims.published, kRowOrder,
                    [](const QuantityInfo& quantity) { return quantity.bound != BoundOn::kControl; }) {}

  void run(const Trajectory& trajectory) {
    const enclosure::RoundingToNearest nearest;
    const std::vector<Sample>& rows = trajectory.samples;
    for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
      include(rows[k], rows[k + 1]);
      if (!claims_.task.empty()) include_task(rows[k], rows[k + 1]);
    }
    if (is_limited(LimitedTorqueRate::info, claims_.published)) torque_rates(trajectory);
  }
  const LimitReaches& limits() const { return limits_; }
  const TaskReaches& task() const { return task_; }
  const Gap& gap() const { return gap_; }

 private:
  void include(const Sample& from, const Sample& to) {
    const RowPolynomials rows = RowPolynomials::between(from, to);
    const RowPolynomials over = rows.shifted(Ball::between(0, rows.duration.upper()));
    const std::vector<Polynomial>& values = quantities_.along({rows.state, over.state, rows.torque, over.torque});
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t limit = quantities_.limits()[i];
      if (!limits_[limit].include(values[i], rows.duration, from.time)) note(limit);
    }
  }
  // Includes each part of the interval in the segment that it belongs to.
  void include_task(const Sample& from, const Sample& to) {
    const RowPolynomials rows = RowPolynomials::between(from, to);
    for (double begin = from.time; begin < to.time;) {
      const std::vector<double>& ends = claims_.task.ends;
      const auto next = std::upper_bound(ends.begin(), ends.end(), begin);
      const double end = next == ends.end() ? to.time : std::min(*next, to.time);
      const Ball length = Ball(end) - Ball(begin);
      const RowPolynomials near = rows.shifted(Ball(begin) - Ball(from.time));
      const RowPolynomials over = near.shifted(Ball::between(0, length.upper()));
      if (!task_.include({near.state.q, over.state.q}, length, begin, claims_.task.segment_at(0.5 * (begin + end)))) {
        gap_.note(task_.gap().time, task_.gap().reason + " in the published rows");
      }
      begin = end;
    }
  }
  // Includes the same difference quotients as limits.cc.
  void torque_rates(const Trajectory& trajectory) {
    const std::vector<Sample>& rows = trajectory.samples;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const std::size_t limit = Quantities::first_limit<LimitedTorqueRate>() + j;
      if (!(kLimitNames[limit].in(claims_.published) < kNoLimit)) continue;
      const FrictionLaw law = FrictionLaw::of(robot_, static_cast<int>(j));
      std::vector<Ball> u;
      for (const Sample& row : rows) u.push_back(Ball(row.torque[j]) - law.nonlinear(Ball(row.state.dtheta[j])));
      const auto at = [&](const BetweenRows& b) {
        if (b.time == rows[b.row].time) return u[b.row];
        if (b.time == rows[b.row + 1].time) return u[b.row + 1];
        const Ball from(rows[b.row].time), to(rows[b.row + 1].time);
        return u[b.row] + (Ball(b.time) - from) / (to - from) * (u[b.row + 1] - u[b.row]);
      };
      each_pair_for_torque_rates(rows, [&](const BetweenRows& earlier, const BetweenRows& later) {
        const Ball rate = (at(later) - at(earlier)) / (Ball(later.time) - Ball(earlier.time));
        if (!limits_[limit].include({rate, 0}, 0, later.time)) note(limit);
      });
    }
  }
  void note(std::size_t limit) {
    const LimitName& name = kLimitNames[limit];
    gap_.note(limits_[limit].time(), fmt::format("{} may reach {:.9g} in the published rows, its limit is {:.9g}",
                                                 whose(name), limits_.bound(limit), name.in(claims_.published)));
  }

  const Parameters& robot_;
  const Claims& claims_;
  LimitReaches limits_;
  TaskReaches task_;
  QuantitySeries quantities_;
  Gap gap_;
};

std::vector<TaskBound> task_bounds(const TaskReaches& published, const TaskReaches& rollout) {
  std::vector<TaskBound> bounds;
  const auto of_rollout = rollout.clearances();
  for (const TaskReaches::Clearance& c : published.clearances()) {
    bounds.push_back({c.name, c.link, c.unit, c.clearance, c.time, of_rollout[bounds.size()].clearance});
  }
  return bounds;
}

// Returns the pieces of a closed-loop rollout: to the end, divided where segments of the motion end.
std::vector<Piece> closed_loop_pieces(const Parameters& robot, const Trajectory& trajectory, const TaskOfMotion& task) {
  const Drive drive = Drive::closed_loop(trajectory, robot);
  std::vector<Piece> pieces;
  for (const double end : task.empty() ? std::vector<double>{} : task.ends) {
    if (end > trajectory.start_time() && end < trajectory.end_time()) pieces.push_back({end, drive, pieces.empty()});
  }
  pieces.push_back({trajectory.end_time(), drive, pieces.empty()});
  return pieces;
}

std::vector<LimitBound> limit_bounds(const Claims& claims, const LimitReaches& published, const LimitReaches& rollout) {
  std::vector<LimitBound> bounds;
  for (std::size_t i = 0; i < kLimits; ++i) {
    const LimitName& name = kLimitNames[i];
    if (!(name.in(claims.published) < kNoLimit)) continue;
    LimitBound b{name.quantity->name, name.joint, name.in(claims.published), published.bound(i), {}};
    if (name.in(claims.rollout) < kNoLimit) b.rollout = rollout.bound(i);
    bounds.push_back(b);
  }
  return bounds;
}

}  // namespace

Claims Claims::of(const Parameters& robot, const Limits& limits, const TaskOfMotion& task) {
  Claims claims{exactness_tolerance(robot),
                rollout_velocity_tolerance(robot),
                rollout_motor_velocity_tolerance(robot),
                feedback_limit(robot),
                limits,
                rollout_allowance(robot, limits),
                task,
                kPublishedFraction};
  for (const LimitName& name : kLimitNames) name.in(claims.published) *= 1 + kPublishedFraction;
  return claims;
}

void demand_proof(const Parameters& robot, const Limits& limits, const TaskOfMotion& task, const Trajectory& trajectory,
                  Certificate& certificate, const ForEach& for_each, const std::function<bool()>& stopped) {
  certificate.proof = prove(robot, limits, task, trajectory, for_each, stopped);
  if (certificate.proof.proven) return;
  certificate.certified = false;
  certificate.failures.push_back(certificate.proof.reason);
}

Proof prove(const Parameters& robot, const Limits& limits, const TaskOfMotion& task, const Trajectory& trajectory,
            const ForEach& for_each, const std::function<bool()>& stopped) {
  return prove(robot, trajectory, Claims::of(robot, limits, task), for_each, stopped);
}

Proof prove(const Parameters& robot, const Trajectory& trajectory, const Claims& claims, const ForEach& for_each,
            const std::function<bool()>& stopped) {
  const enclosure::RoundingToNearest nearest;
  Proof proof;
  proof.evaluated = true;
  if (auto reason = malformed(trajectory)) {
    proof.reason = std::move(*reason);
    return proof;
  }
  LoopProver open(robot, claims, false, stopped), closed(robot, claims, true, stopped);
  RowsProver rows(robot, claims);
  const std::array<std::function<void()>, 3> parts{
      [&] {
        const std::vector<Stretch> stretches = stretches_of_amplification(robot, trajectory);
        open.run(trajectory, open_loop_pieces(robot, trajectory, stretches));
      },
      [&] { closed.run(trajectory, closed_loop_pieces(robot, trajectory, claims.task)); },
      [&] { rows.run(trajectory); }};
  for_each(parts.size(), [&](std::size_t i) { parts[i](); });
  proof.open_loop = open.result();
  proof.closed_loop = closed.result();
  proof.limits = limit_bounds(claims, rows.limits(), closed.limits());
  proof.task = task_bounds(rows.task(), closed.task());
  Gap first;
  if (!proof.open_loop.proven) first.note(proof.open_loop.until, "open loop: " + proof.open_loop.reason);
  if (!proof.closed_loop.proven) first.note(proof.closed_loop.until, "closed loop: " + proof.closed_loop.reason);
  first.note(rows.gap().time, rows.gap().reason);
  proof.proven = first.reason.empty();
  proof.until = proof.proven ? trajectory.end_time() : first.time;
  if (!proof.proven) proof.reason = fmt::format("not proven from t = {:.6f} s: {}", first.time, first.reason);
  return proof;
}

}  // namespace fjr
