#include "planner/learning/correction.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "common/input_error.h"
#include "common/smooth_step.h"
#include "planner/certificate/residual.h"
#include "planner/control/motor_feedback.h"

namespace fjr {
namespace {

// The state vector of the regulator: deviation of the arm's state from that of the last run, then the torque
// correction.
constexpr int kTorque = kStates, kDeviations = kStates + kJoints;
using Deviations = Eigen::Matrix<double, kDeviations, 1>;
using DeviationsMatrix = Eigen::Matrix<double, kDeviations, kDeviations>;
using Input = Eigen::Matrix<double, kDeviations, kJoints>;

// Weights of the cost: each of these values costs as much as a link error of one count at one tick. After ten
// repetitions the errors are the same with a tenth or ten times of either torque weight, except that ten times the
// increment amplifies noise: errors of 1.5 counts of both links instead of 0.4 and 1.
constexpr double kIncrement = 0.01;  // fraction of the torque limit: change of the correction from tick to tick
constexpr double kFirst = 0.1;       // fraction of the torque limit: first value of the correction
constexpr double kLastVelocity =
    1e-4;  // [rad/s] velocity of links and motors at the last tick, where the plan may still brake

// Iterations of the Gauss-Newton method. The first one assumes that motors reverse when they did in the last run, with
// the same slopes of friction. Alone it leaves errors of 2.5 to 4.4 counts of link 2, where two or more leave one
// count.
constexpr int kIterations = 3;
constexpr double kSameStart = 2;   // [motor counts] up to which two initial positions of a motor count as the same
constexpr double kOntoPlan = 0.3;  // [s] in which the desired link positions blend from the initial ones to the plan

struct Affine {  // next = a z + b v + c
  DeviationsMatrix a;
  Input b;
  Deviations c;
};

struct Law {  // v = -gain z - offset
  Eigen::Matrix<double, kJoints, kDeviations> gain;
  Eigen::Vector2d offset;
};

Eigen::Vector2d pair(const Joints<double>& v) { return {v[0], v[1]}; }

// States and torques of a past or future run, per tick.
struct Course {
  std::vector<State<double>> states;
  std::vector<Joints<double>> torque;  // [N m] in the tick that begins there
};

class Regulator {
 public:
  Regulator(const Parameters& robot, const Trajectory& executed, const SmoothedRun& run,
            const std::optional<Joints<double>>& began_before)
      : robot_(robot),
        run_(run),
        arm_(robot),
        begins_(start_of_next(robot, run.states.front(), executed.samples.front().state.theta, began_before)),
        onto_plan_(std::min(kOntoPlan, 0.5 * (run.times.back() - run.times.front()))) {
    Interpolator rows(executed);
    const PlannedDither dither(robot, executed);
    for (std::size_t k = 0; k < run.times.size(); ++k) {
      const double now = run.times[k], next = k + 1 < run.times.size() ? run.times[k + 1] : now + kTick;
      planned_.push_back(rows.at(now).state);
      const Joints<double> mean = rows.mean_torque(now, next), swing = dither.at(now);
      commanded_.push_back({mean[0] + swing[0], mean[1] + swing[1]});
    }
    unexplained_.resize(ticks());
    for (std::size_t k = 0; k < ticks(); ++k) unexplained_[k] = -defect(k, run.states, run.torque[k]);
  }

  Correction solve() {
    Course course{run_.states, run_.torque};
    Correction correction;
    for (int i = 0; i < kIterations; ++i) {
      linearise(course);
      correction = improve(course);
    }
    return correction;
  }

 private:
  std::size_t ticks() const { return run_.times.size() - 1; }
  double limit(Eigen::Index j) const { return robot_.limits.torque[static_cast<std::size_t>(j)]; }

  // Returns the expected state at the start of the next run, at rest. A motor is expected where it began in the last
  // run if that agrees with its reference, or with where the run before began. Otherwise its position was accidental,
  // and it is expected at the reference. The deflection of the springs under gravity is taken from the last run,
  // because it differs from the model's if the arm does.
  static State<double> start_of_next(const Parameters& robot, const State<double>& last,
                                     const Joints<double>& reference,
                                     const std::optional<Joints<double>>& began_before) {
    State<double> next{last.q, {}, last.theta, {}};
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto began_at = [&](double theta) {
        return std::abs(last.theta[j] - theta) <= kSameStart * count_angle(robot.encoder.motor_counts[j]);
      };
      if (!began_at(reference[j]) && !(began_before && began_at((*began_before)[j]))) next.theta[j] = reference[j];
    }
    if (next.theta == last.theta) return next;
    Joints<double> bent = rest_at(robot, last.q).theta;
    for (std::size_t j = 0; j < kJoints; ++j) bent[j] += next.theta[j] - last.theta[j];
    next.q = resting_with(robot, bent);
    return next;
  }

  // Returns the desired link positions: the plan, blended from where the links begin.
  Joints<double> wanted(std::size_t k) const {
    const double left = 1 - smooth_step((run_.times[k] - run_.times[0]) / onto_plan_);
    Joints<double> q = planned_[k].q;
    for (std::size_t j = 0; j < kJoints; ++j) q[j] += left * (begins_.q[j] - planned_[0].q[j]);
    return q;
  }

  // Returns the simulated state at the end of tick k minus that of the course.
  Eigen::Matrix<double, kStates, 1> defect(std::size_t k, const std::vector<State<double>>& states,
                                           const Joints<double>& torque) {
    const auto to = arm_.advance(run_.times[k], run_.times[k + 1], states[k], torque, run_.lacking[k]);
    if (!to) {
      throw InputError(run_.log, "",
                       fmt::format("the arm with what this run tells cannot be rolled out at {:.3f} s: nothing can be "
                                   "learnt from it",
                                   run_.times[k]));
    }
    Eigen::Matrix<double, kStates, 1> beside;
    for (std::size_t i = 0; i < kStates; ++i) beside[static_cast<Eigen::Index>(i)] = (*to)[i] - states[k + 1][i];
    return beside;
  }

  // Linearises the arm along the course. The next run is expected to command the planned torque and the dither, and no
  // feedback, because the arm then follows its reference.
  void linearise(const Course& course) {
    steps_.resize(ticks());
    for (std::size_t k = 0; k < ticks(); ++k) {
      const TickSlopes slopes = tick_slopes(robot_, course.states[k], course.states[k + 1], course.torque[k],
                                            run_.lacking[k], run_.times[k + 1] - run_.times[k]);
      Affine& step = steps_[k];
      step = {DeviationsMatrix::Identity(), Input::Zero(), Deviations::Zero()};
      step.a.topLeftCorner<kStates, kStates>() = slopes.state;
      step.a.topRightCorner<kStates, kJoints>() = slopes.torque;
      step.b.topRows<kStates>() = 0.5 * slopes.torque;  // the mean of a torque that is linear over the tick
      step.b.bottomRows<kJoints>().setIdentity();
      step.c.head<kStates>() = slopes.torque * (pair(commanded_[k]) - pair(course.torque[k])) +
                               defect(k, course.states, course.torque[k]) + unexplained_[k];
    }
  }

  Correction improve(Course& course) const {
    std::vector<Law> laws(ticks());
    DeviationsMatrix p = DeviationsMatrix::Zero();
    Deviations slope = Deviations::Zero();
    add_link_error(ticks(), course, p, slope);
    add_last_velocity(course, p, slope);
    for (std::size_t k = ticks(); k-- > 0;) {
      const Affine& step = steps_[k];
      const Input pb = p * step.b;
      Eigen::Matrix2d h = step.b.transpose() * pb;
      for (Eigen::Index j = 0; j < kJoints; ++j) h(j, j) += 1 / std::pow(kIncrement * limit(j), 2);
      const Eigen::LDLT<Eigen::Matrix2d> factors(h);
      laws[k].gain = factors.solve(pb.transpose() * step.a);
      laws[k].offset = factors.solve(pb.transpose() * step.c + step.b.transpose() * slope);
      slope = step.a.transpose() * (p * (step.c - step.b * laws[k].offset) + slope);
      p = step.a.transpose() * p * (step.a - step.b * laws[k].gain);
      p = 0.5 * (p + p.transpose()).eval();
      add_link_error(k, course, p, slope);
    }
    return along(first(course, p, slope), laws, course);
  }

  void add_link_error(std::size_t k, const Course& course, DeviationsMatrix& p, Deviations& slope) const {
    const Joints<double> q = wanted(k);
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto row = static_cast<Eigen::Index>(kStateQ + j);
      const double weight = 1 / std::pow(count_angle(robot_.encoder.link_counts[j]), 2);
      p(row, row) += weight;
      slope[row] -= weight * (q[j] - course.states[k].q[j]);
    }
  }

  void add_last_velocity(const Course& course, DeviationsMatrix& p, Deviations& slope) const {
    const double weight = 1 / std::pow(kLastVelocity, 2);
    const auto add = [&](std::size_t row) {
      const auto i = static_cast<Eigen::Index>(row);
      p(i, i) += weight;
      slope[i] -= weight * (planned_.back()[row] - course.states.back()[row]);
    };
    for (std::size_t j = 0; j < kJoints; ++j) {
      add(kStateDq + j);
      add(kStateDtheta + j);
    }
  }

  // Returns the initial deviation, with the first torque correction that minimises the cost of the rest.
  Deviations first(const Course& course, const DeviationsMatrix& p, const Deviations& slope) const {
    Deviations z = Deviations::Zero();
    for (std::size_t i = 0; i < kStates; ++i) z[static_cast<Eigen::Index>(i)] = begins_[i] - course.states[0][i];
    Eigen::Matrix2d h = p.bottomRightCorner<kJoints, kJoints>();
    for (Eigen::Index j = 0; j < kJoints; ++j) h(j, j) += 1 / std::pow(kFirst * limit(j), 2);
    z.tail<kJoints>() =
        -h.ldlt().solve(p.bottomLeftCorner<kJoints, kStates>() * z.head<kStates>() + slope.tail<kJoints>());
    return z;
  }

  Correction along(Deviations z, const std::vector<Law>& laws, Course& course) const {
    Correction correction{run_.times, {}, {}, {}, begins_};
    for (std::size_t k = 0;; ++k) {
      State<double>& x = course.states[k];
      for (std::size_t i = 0; i < kStates; ++i) x[i] += z[static_cast<Eigen::Index>(i)];
      const auto off = [&](const Joints<double>& of, const Joints<double>& from) {
        return Joints<double>{of[0] - from[0], of[1] - from[1]};
      };
      correction.torque.push_back({z[kTorque], z[kTorque + 1]});
      correction.theta.push_back(off(x.theta, planned_[k].theta));
      correction.dtheta.push_back(off(x.dtheta, planned_[k].dtheta));
      if (k == ticks()) return correction;
      const Eigen::Vector2d increment = -laws[k].gain * z - laws[k].offset;
      const Eigen::Vector2d mean = z.tail<kJoints>() + 0.5 * increment;
      course.torque[k] = {commanded_[k][0] + mean[0], commanded_[k][1] + mean[1]};
      z = steps_[k].a * z + steps_[k].b * increment + steps_[k].c;
    }
  }

  const Parameters& robot_;
  const SmoothedRun& run_;
  LackingArm arm_;
  State<double> begins_;
  double onto_plan_;  // [s]
  std::vector<State<double>> planned_;
  std::vector<Joints<double>> commanded_;
  std::vector<Eigen::Matrix<double, kStates, 1>> unexplained_;
  std::vector<Affine> steps_;
};

// Returns the times of the samples and of the correction, merged. A time of the correction less than 2 kJumpSpacing
// from a sample is left out.
std::vector<double> times_of(const Trajectory& executed, const Correction& correction) {
  std::vector<double> rows, ticks, all;
  for (const Sample& row : executed.samples) rows.push_back(row.time);
  for (const double time : correction.times) {
    const auto after = std::lower_bound(rows.begin(), rows.end(), time);
    const bool beside = (after != rows.end() && *after - time < 2 * kJumpSpacing) ||
                        (after != rows.begin() && time - *std::prev(after) < 2 * kJumpSpacing);
    if (!beside && time > rows.front() && time < rows.back()) ticks.push_back(time);
  }
  std::merge(rows.begin(), rows.end(), ticks.begin(), ticks.end(), std::back_inserter(all));
  return all;
}

// Returns the correction as a trajectory, so that it is interpolated like one.
Trajectory as_rows(const Correction& correction, double fraction) {
  Trajectory rows;
  for (std::size_t k = 0; k < correction.times.size(); ++k) {
    Sample row;
    row.time = correction.times[k];
    for (std::size_t j = 0; j < kJoints; ++j) {
      row.state.theta[j] = fraction * correction.theta[k][j];
      row.state.dtheta[j] = fraction * correction.dtheta[k][j];
      row.torque[j] = fraction * correction.torque[k][j];
    }
    rows.samples.push_back(row);
  }
  return rows;
}

}  // namespace

Correction correction_after(const Parameters& robot, const Trajectory& executed, const SmoothedRun& run,
                            const std::optional<Joints<double>>& began_before) {
  return Regulator(robot, executed, run, began_before).solve();
}

Trajectory corrected(const Trajectory& executed, const Correction& correction, double fraction) {
  const Trajectory by = as_rows(correction, fraction);
  Interpolator plan(executed), change(by);
  Trajectory result{{}, executed.metadata};
  for (const double time : times_of(executed, correction)) {
    Sample row = plan.at(time);
    const Sample more = change.at(time);
    const bool at_end = time == executed.start_time() || time == executed.end_time();
    for (std::size_t j = 0; j < kJoints; ++j) {
      row.state.theta[j] += more.state.theta[j];
      if (!at_end) row.state.dtheta[j] += more.state.dtheta[j];  // at both ends the arm rests
      row.torque[j] += more.torque[j];
    }
    result.samples.push_back(row);
  }
  return result;
}

}  // namespace fjr
