#include "planner/ocp/margins.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/friction.h"
#include "planner/ocp/sampling.h"
#include "planner/ocp/segments.h"
#include "planner/problem/task/task.h"
#include "planner/trajectory/motion.h"

namespace fjr {
namespace {

constexpr int kProbes = 16;           // steps to check an interval; polynomials of degree <= 5 vary little within one
constexpr double kEnlarge = 1.2;      // a margin grows by this times the excess
constexpr double kLeast = 1e-5;       // fraction of a limit; a smaller margin would have no effect in the optimiser
constexpr double kNegligible = 1e-7;  // fraction of a limit; smaller excesses are ignored, a tenth of the certificate's
constexpr double kAbovePeak = 3e-3;   // fraction of a penalised peak; smaller excesses do not justify another solve
constexpr double kMostMargin = 0.5;   // fraction of a limit that a margin may take: the bounds must not cross
constexpr double kRunThrough = 0.1;   // fraction of a task's scale; see widen()
constexpr double kWindow = 0.03;      // fraction of the motion around a state on a limit in which margins do not act

Joints<double> sum(const Joints<double>& a, const Joints<double>& b) { return {a[0] + b[0], a[1] + b[1]}; }

// Returns the largest magnitude of each limited quantity on interval k.
Limits reached_in(const Problem& problem, const Joints<FrictionLaw>& friction, const Motion& motion, std::size_t k) {
  Limits reached = Limits::all(0);
  const auto& interval = motion.intervals[k];
  const auto limited = [&](const QuantityInfo& info) { return is_limited(info, problem.limits); };
  const auto limited_torque = [&](const QuantityInfo& info) { return info.sees_torque && limited(info); };
  Joints<double> u_before{}, friction_before{};
  for (int i = 0; i <= kProbes; ++i) {
    const double time = interval.start + interval.duration * i / kProbes;
    const State<double> x = motion.state_in(k, time);
    const Joints<double> u = motion.torque_in(k, time);
    Joints<double> now, torque, rate{};
    for (std::size_t j = 0; j < kJoints; ++j) {
      now[j] = friction[j].nonlinear(x.dtheta[j]);
      torque[j] = u[j] + now[j];
      if (i > 0) rate[j] = (u[j] - u_before[j]) * kProbes / interval.duration;
    }
    raise(reached, {problem.robot, x, torque, rate}, limited);
    if (i > 0) {  // friction may step anywhere between two probes, so each u is also combined with the other's friction
      const Joints<double> later = sum(u, friction_before), earlier = sum(u_before, now);
      raise(reached, {problem.robot, x, later, rate}, limited_torque);
      raise(reached, {problem.robot, x, earlier, rate}, limited_torque);
    }
    u_before = u;
    friction_before = now;
  }
  return reached;
}

// Returns the smallest clearance of each task constraint on interval k.
std::vector<double> clearance_in(const Problem& problem, const std::vector<TaskRow>& rows, const Motion& motion,
                                 std::size_t k) {
  std::vector<double> clearance(rows.size(), kNoLimit);
  if (rows.empty()) return clearance;
  const auto& interval = motion.intervals[k];
  for (int i = 0; i <= kProbes; ++i) {
    const State<double> x = motion.state_in(k, interval.start + interval.duration * i / kProbes);
    const auto posture = Posture<double>::of(problem.robot, x.q);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      clearance[r] = std::min(clearance[r], rows[r].clearance(rows[r].value(problem.robot, posture)));
    }
  }
  return clearance;
}

std::vector<std::vector<TaskRow>> rows_by_segment(const Problem& problem) {
  std::vector<std::vector<TaskRow>> rows;
  for (std::size_t s = 0; s < segment_count(problem); ++s) {
    rows.push_back(task_rows(problem.robot, problem.task, s));
  }
  return rows;
}

// A state that the request prescribes: its place along the motion, counted in segments, and its distance to each limit.
struct PrescribedState {
  double place;
  PerLimit clearance;
};

PrescribedState prescribed_at(const Problem& problem, double place, std::size_t segment, const State<double>& x) {
  Limits needs = Limits::all(0);
  const Joints<double> nothing{};
  raise(needs, {problem.robot, x, nothing, nothing}, [](const QuantityInfo&) { return true; });
  PrescribedState prescribed{place, {}};
  for (const LimitName& name : kLimitNames) prescribed.clearance.push_back(name.in(problem.limits) - name.in(needs));
  const auto posture = Posture<double>::of(problem.robot, x.q);
  for (const TaskRow& row : task_rows(problem.robot, problem.task, segment)) {
    prescribed.clearance.push_back(row.clearance(row.value(problem.robot, posture)));
  }
  return prescribed;
}

std::vector<PrescribedState> prescribed_states(const Problem& problem) {
  std::vector<PrescribedState> prescribed{prescribed_at(problem, 0, 0, problem.start)};
  for (std::size_t i = 0; i < problem.via.size(); ++i) {  // unprescribed velocities count as 0
    const Via& via = problem.via[i];
    if (via.tolerance > 0) {  // a corner of a path prescribes only angles, to a tolerance
      prescribed.push_back(prescribed_at(problem, static_cast<double>(i) + 1, i, {via.q, {0, 0}, via.q, {0, 0}}));
      std::fill(prescribed.back().clearance.begin() + kLimits, prescribed.back().clearance.end(), kNoLimit);
      continue;
    }
    const Joints<double> dq = via.dq.value_or(Joints<double>{0, 0});
    prescribed.push_back(prescribed_at(problem, static_cast<double>(i) + 1, i, {via.q, dq, via.q, {0, 0}}));
  }
  const Goal& goal = problem.goal;
  const Joints<double> still{0, 0};
  const auto end = static_cast<double>(segment_count(problem));
  prescribed.push_back(prescribed_at(problem, end, segment_count(problem) - 1,
                                     {goal.q, goal.dq, goal.theta.value_or(goal.q), goal.dtheta.value_or(still)}));
  if (!goal.any_free()) return prescribed;
  // One angle is prescribed alone, so that nothing but its own limit is known to be near.
  PerLimit& clearance = prescribed.back().clearance;
  for (std::size_t i = 0; i < clearance.size(); ++i) {
    const bool known = i < kLimits && kLimitNames[i].is_of(LinkPosition::info) && !goal.free[kLimitNames[i].j()];
    if (!known) clearance[i] = kNoLimit;
  }
  return prescribed;
}

// The part of the margins that does not depend on a motion: base margins, reserve, and where margins cannot act.
class MarginRules {
 public:
  explicit MarginRules(const Problem& problem)
      : problem_(problem), prescribed_(prescribed_states(problem)), scale_(limit_scales(problem)) {}

  std::size_t count() const { return scale_.size(); }
  double scale(std::size_t i) const { return scale_[i]; }

  // Returns the base margin of limit i, or 0 if a prescribed state is closer to the limit than that.
  double base_margin(std::size_t i) const {
    const bool none =
        std::any_of(prescribed_.begin(), prescribed_.end(), [&](const PrescribedState& g) { return lies_on(g, i); });
    return none ? 0 : kBaseMargin * scale_[i];
  }

  // Returns whether margins of limit i cannot act on an interval, because a prescribed state nearby lies on the limit
  // or closer to it than `needed`, and moving away from a limit takes time. from, to: the interval, counted in
  // segments. Task constraints are treated like limits on positions.
  bool cannot_act(std::size_t i, double from, double to, double needed = 0) const {
    const Leaving leaving = i < kLimits ? kLimitNames[i].quantity->leaving : Leaving::kSlowly;
    if (leaving == Leaving::kAtOnce) return false;
    const double window = leaving == Leaving::kSlowly ? kWindow * static_cast<double>(segment_count(problem_)) : 1e-9;
    return std::any_of(prescribed_.begin(), prescribed_.end(), [&](const PrescribedState& g) {
      const bool close = lies_on(g, i) || g.clearance[i] < needed;
      return close && from < g.place + window && to > g.place - window;
    });
  }

  // Returns the reserve for the uncertainty of the arm, or 0 if a prescribed state lies closer to the limit.
  double reserve(std::size_t i, double from, double to) const {
    const double kept = problem_.variation.reserve.largest(i, from, to);
    return kept > 0 && !cannot_act(i, from, to, kept + base_margin(i)) ? kept : 0;
  }

 private:
  bool lies_on(const PrescribedState& prescribed, std::size_t i) const {
    return prescribed.clearance[i] < kBaseMargin * scale_[i];
  }

  const Problem& problem_;
  std::vector<PrescribedState> prescribed_;
  std::vector<double> scale_;
};

// Returns the places of the nodes of the mesh, counted in segments.
std::vector<double> places(const Mesh& mesh) {
  return mesh.node_times(std::vector<double>(static_cast<std::size_t>(mesh.segments()), 1.0));
}

}  // namespace

PerLimit limit_scales(const Problem& problem) {
  PerLimit scales;
  for (const LimitName& limit : kLimitNames) scales.push_back(limit.in(problem.limits));
  for (const TaskRow& row : task_rows(problem.robot, problem.task, 0)) scales.push_back(row.scale);
  return scales;
}

std::vector<TightenedLimits> tightened_limits(const Problem& problem, const Mesh& mesh,
                                              const std::vector<PerLimit>& margins) {
  const MarginRules rules(problem);
  const auto rows = rows_by_segment(problem);
  const std::vector<double> nodes = places(mesh);
  std::vector<TightenedLimits> tightened;
  for (std::size_t k = 0; k < mesh.size(); ++k) {
    TightenedLimits here{problem.limits, {}};
    for (const TaskRow& row : rows[static_cast<std::size_t>(mesh.intervals[k].segment)]) {
      here.task_rows.push_back({row.lower, row.upper});
    }
    for (std::size_t i = 0; i < rules.count(); ++i) {
      double off = rules.base_margin(i);
      if (!margins.empty() && !rules.cannot_act(i, nodes[k], nodes[k + 1])) off += margins[k][i];
      off += rules.reserve(i, nodes[k], nodes[k + 1]);
      if (i < kLimits) {
        double& limit = kLimitNames[i].in(here.limits);
        if (std::isfinite(off)) limit = std::max(limit - off, 0.0);
      } else {
        here.task_rows[i - kLimits][0] += off;
        here.task_rows[i - kLimits][1] -= off;
      }
    }
    tightened.push_back(std::move(here));
  }
  return tightened;
}

std::vector<PerLimit> excesses(const Problem& problem, const Mesh& mesh, const Motion& solved, double base_margin,
                               double slack) {
  const Motion motion = with_integrated_positions(solved, mesh);  // as it is published
  const Joints<FrictionLaw> friction{FrictionLaw::of(problem.robot, 0), FrictionLaw::of(problem.robot, 1)};
  const MarginRules rules(problem);
  const std::optional<Slack>& relaxing = problem.variation.slack;
  const auto rows = rows_by_segment(problem);
  const std::vector<double> nodes = places(mesh);
  std::vector<PerLimit> result;
  for (std::size_t k = 0; k < motion.intervals.size(); ++k) {
    const Limits reached = reached_in(problem, friction, motion, k);
    const std::vector<double> clearance =
        clearance_in(problem, rows[static_cast<std::size_t>(mesh.intervals[k].segment)], motion, k);
    PerLimit excess(rules.count(), 0.0);
    for (std::size_t i = 0; i < rules.count(); ++i) {
      const double scale = rules.scale(i);
      const double beyond =
          i < kLimits ? kLimitNames[i].in(reached)-kLimitNames[i].in(problem.limits) : -clearance[i - kLimits];
      const double relaxed_by = relaxing && i < relaxing->direction.size() ? slack * relaxing->direction[i] : 0;
      const double over =
          beyond - relaxed_by + base_margin * rules.base_margin(i) + rules.reserve(i, nodes[k], nodes[k + 1]);
      const bool counts =
          std::isfinite(scale) && over > kNegligible * scale && !rules.cannot_act(i, nodes[k], nodes[k + 1]);
      if (counts) excess[i] = over;
    }
    result.push_back(std::move(excess));
  }
  return result;
}

void add_excesses_of_peak(std::vector<PerLimit>& excesses, const Problem& problem, const Motion& motion,
                          const Joints<double>& peak) {
  const Joints<FrictionLaw> friction{FrictionLaw::of(problem.robot, 0), FrictionLaw::of(problem.robot, 1)};
  for (std::size_t k = 0; k < motion.intervals.size(); ++k) {
    const Limits reached = reached_in(problem, friction, motion, k);
    for (std::size_t j = 0; j < kJoints; ++j) {
      double& excess = excesses[k][Quantities::first_limit<Torque>() + j];
      const double above = reached.torque[j] - peak[j];
      if (above > kAbovePeak * peak[j]) excess = std::max(excess, above);
    }
  }
}

double largest_tightening(const Problem& problem, const std::vector<PerLimit>& margins) {
  const PerLimit scales = limit_scales(problem);
  double fraction = kBaseMargin;
  for (const PerLimit& margin : margins) {
    for (std::size_t i = 0; i < scales.size(); ++i) {
      if (std::isfinite(scales[i])) fraction = std::max(fraction, kBaseMargin + margin[i] / scales[i]);
    }
  }
  return fraction;
}

std::string worst_excess(const Problem& problem, const Mesh& mesh, const Motion& motion) {
  const std::vector<PerLimit> excess = excesses(problem, mesh, motion);
  const PerLimit scales = limit_scales(problem);
  double worst = 0;
  std::string sentence;
  // Sets `sentence` to sentence_of(excess, time) where limit i is exceeded by the largest fraction so far.
  const auto consider = [&](std::size_t i, auto&& sentence_of) {
    for (std::size_t k = 0; k < excess.size(); ++k) {
      const double fraction = excess[k][i] / scales[i];
      if (!(fraction > worst)) continue;
      worst = fraction;
      sentence = sentence_of(excess[k][i], motion.intervals[k].start);
    }
  };
  for (std::size_t i = 0; i < kLimits; ++i) {
    consider(i, [&](double over, double time) {
      const auto& [quantity, joint] = kLimitNames[i];
      const std::string of_joint = joint == 0 ? "" : fmt::format(" of joint {}", joint);
      return fmt::format("{}{} exceeds its limit {:.6g} {} by {:.3g} at {:.3f} s", quantity->name, of_joint, scales[i],
                         quantity->unit, over, time);
    });
  }
  const std::vector<TaskRow> rows = task_rows(problem.robot, problem.task, 0);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    consider(kLimits + r, [&](double over, double time) {
      const std::string of_link = rows[r].link == 0 ? "" : fmt::format(" by link {}", rows[r].link);
      return fmt::format("{} is missed{} by {:.3g} {} at {:.3f} s", rows[r].name, of_link, over, rows[r].unit(), time);
    });
  }
  return sentence;
}

bool widen(std::vector<PerLimit>& margins, const std::vector<PerLimit>& excesses, const Problem& problem,
           double growth) {
  const PerLimit scales = limit_scales(problem);
  if (margins.empty()) margins.assign(excesses.size(), PerLimit(scales.size(), 0.0));
  bool any = false;
  for (std::size_t k = 0; k < margins.size(); ++k) {
    for (std::size_t i = 0; i < scales.size(); ++i) {
      // Where the motion passes through an obstacle, a finer mesh is needed. A margin of that size would also block the
      // free path beside the obstacle.
      if (!(excesses[k][i] > 0) || (i >= kLimits && excesses[k][i] > kRunThrough * scales[i])) continue;
      double& margin = margins[k][i];
      const double before = margin;
      margin += std::max((growth - 1) * margin, kEnlarge * excesses[k][i] + kLeast * scales[i]);
      margin = std::min(margin, kMostMargin * scales[i]);
      any = any || margin > before;
    }
  }
  return any;
}

}  // namespace fjr
