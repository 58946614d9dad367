#include "planner/certificate/robust/robustness.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "common/input_error.h"
#include "common/normal.h"
#include "planner/certificate/robust/sensitivities.h"
#include "planner/certificate/simulation.h"
#include "planner/certificate/ticks.h"
#include "planner/problem/task/task.h"

namespace fjr {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Number of the N drawn arms that may lie outside. With one, a quarter fewer draws would do, but the tubes would be
// more conservative.
constexpr std::size_t kOutside = 2;
// Arms that are drawn to find how wide the tubes of the channels should be relative to each other: deviations by
// encoder counts have longer tails than those by parameters.
constexpr Eigen::Index kScouts = 100;
// The largest deviation that encoder counts cause on one motion is taken for this many standard deviations.
constexpr double kPeakOfCounts = 3;
// Least standard deviation of a channel at any time, as a fraction of its largest one, because deviations by counts may
// come at any time. Of 0, 0.2, 0.4 and 0.8 those between gave the narrowest tubes, with a covariance, with ten and with
// fifty times its errors.
constexpr double kFlattest = 0.3;
constexpr std::size_t kMostPoints = 200;  // of the reported tubes
constexpr int kLooks = 4;                 // instants per tick at which the distance from limits is evaluated
constexpr double kSlowTip = 0.05;         // [m/s] at lower tip speeds, the slope of the speed is taken at this speed

// A quantity that has a tube: a limit, a row of the task, or the position of a link.
struct Channel {
  std::string name, unit;
  int joint = 0;
  double limit = kNoLimit;  // of the magnitude; no meaning for a row of the task
  std::size_t index = 0;    // among kLimitNames, among the task's rows, or of the link
  enum class Kind { kLimit, kTask, kLink } kind = Kind::kLimit;
};

// The channels of a motion, and their values.
class Channels {
 public:
  Channels(const Parameters& robot, const Limits& limits, const TaskOfMotion& task) : task_(task) {
    for (std::size_t i = 0; i < kLimits; ++i) {
      const LimitName& name = kLimitNames[i];
      const QuantityInfo& quantity = *name.quantity;
      if (!std::isfinite(name.in(limits)) || quantity.bound == BoundOn::kControl) continue;
      const double limit = quantity.with_feedback_in(robot, limits, name.j());
      all_.push_back({quantity.name, quantity.unit, name.joint, limit, i, Channel::Kind::kLimit});
    }
    if (!task.rows.empty()) {
      for (std::size_t r = 0; r < task.rows.front().size(); ++r) {
        const TaskRow& row = task.rows.front()[r];
        all_.push_back({row.name, row.unit(), row.link, kNoLimit, r, Channel::Kind::kTask});
      }
    }
    for (std::size_t j = 0; j < kJoints; ++j) {
      all_.push_back({"link", "rad", static_cast<int>(j) + 1, kNoLimit, j, Channel::Kind::kLink});
    }
  }

  const std::vector<Channel>& all() const { return all_; }
  Eigen::Index count() const { return static_cast<Eigen::Index>(all_.size()); }

  // Returns the values of all channels: limited quantities with their sign (except those whose square is computed) and
  // positions of links. For rows of the task it is the distance from the forbidden region. For rows along a line it is
  // what is left of the tolerance, because an arm that is ahead of the plan at a corner is near the next line.
  VectorXd values(const Parameters& arm, const Sample& at) const {
    VectorXd values(count());
    std::array<double, kLimits> limited{};
    std::size_t next = 0;
    const Joints<double> no_rate{};
    Quantities::visit([&](auto quantity) {
      const auto of_joints = quantity.value(Moment<double>{arm, at.state, at.torque, no_rate});
      for (const double value : of_joints) {
        limited[next++] = quantity.info.squared ? std::sqrt(std::max(0.0, value)) : value;
      }
    });
    const std::size_t segment = task_.rows.empty() ? 0 : task_.segment_at(at.time);
    const auto posture = Posture<double>::of(arm, at.state.q);
    for (Eigen::Index c = 0; c < count(); ++c) {
      const Channel& channel = all_[static_cast<std::size_t>(c)];
      switch (channel.kind) {
        case Channel::Kind::kLimit:
          values[c] = limited[channel.index];
          break;
        case Channel::Kind::kTask:
          values[c] = left_of_row(arm, channel.index, segment, posture);
          break;
        case Channel::Kind::kLink:
          values[c] = at.state.q[channel.index];
      }
    }
    return values;
  }

  // Returns what is left to the limit at this value; infinite for links.
  double left(Eigen::Index c, double value) const {
    const Channel& channel = all_[static_cast<std::size_t>(c)];
    return channel.kind == Channel::Kind::kTask ? value : channel.limit - std::abs(value);
  }

 private:
  double left_of_row(const Parameters& arm, std::size_t index, std::size_t segment,
                     const Posture<double>& posture) const {
    const TaskRow& row = task_.rows[segment][index];
    if (!row.across) return row.distance(row.value(arm, posture));
    double left = -kNoLimit;
    for (std::size_t s = segment > 0 ? segment - 1 : 0; s <= segment + 1 && s < task_.rows.size(); ++s) {
      left = std::max(left, left_of_line(arm, task_.rows[s][*row.across], task_.rows[s][index], posture));
    }
    return left;
  }

  const TaskOfMotion& task_;
  std::vector<Channel> all_;
};

// Returns the plan at the ends of the ticks, with the torque that is commanded in the tick before.
std::vector<Sample> plan_at_ticks(const Trajectory& trajectory) {
  std::vector<Sample> samples;
  Interpolator plan(trajectory);
  double before = trajectory.start_time();
  for (long k = 0; k < tick_count(trajectory); ++k) {
    const double next = std::min(trajectory.end_time(), trajectory.start_time() + static_cast<double>(k + 1) * kTick);
    const Joints<double> torque = plan.mean_torque(before, before + kTick);
    samples.push_back({next, plan.at(next).state, torque});
    before = next;
  }
  return samples;
}

// Rolls out one arm and calls observe(tick, values of all channels) after every tick. Returns false if the arm left
// what can be rolled out, or its drives saturated.
template <class Observe>
bool follow_arm(const Parameters& robot, const Parameters& arm, const Trajectory& trajectory, const Channels& channels,
                const Observe& observe) {
  bool saturated = false;
  std::size_t tick = 0;
  const bool completed =
      roll_out_ticks(robot, arm, trajectory, start_on(robot, arm, trajectory), [&](const SimulatedTick& simulated) {
        saturated |= simulated.command.saturated;
        observe(tick++, channels.values(arm, {simulated.end, simulated.state, simulated.command.torque}));
      });
  return completed && !saturated;
}

// The expected motion of the robot itself and the standard deviations about it.
class ExpectedMotion {
 public:
  ExpectedMotion(const Parameters& robot, const Trajectory& trajectory, const Channels& channels,
                 const Uncertainty& uncertainty)
      : robot_(robot),
        trajectory_(trajectory),
        channels_(channels),
        uncertainty_(uncertainty),
        plan_(plan_at_ticks(trajectory)),
        sensitivities_(sensitivities(robot, trajectory, uncertainty)) {
    planned_.resize(channels.count(), ticks());
    deviation_.resize(channels.count(), ticks());
    for (Eigen::Index k = 0; k < ticks(); ++k) {
      planned_.col(k) = channels.values(robot, plan_[static_cast<std::size_t>(k)]);
      const MatrixXd slopes = gradient(k);
      deviation_.col(k) =
          (slopes * uncertainty.covariance).cwiseProduct(slopes).rowwise().sum().cwiseMax(0).cwiseSqrt();
    }
    add_counts();
    look_between();
  }

  Eigen::Index ticks() const { return static_cast<Eigen::Index>(plan_.size()); }
  double time(Eigen::Index k) const { return plan_[static_cast<std::size_t>(k)].time; }
  // Matrices of channels x ticks, at the end of each tick: the planned value; the standard deviation with the least one
  // of the channel; what is left to the limit during the tick.
  const MatrixXd& planned() const { return planned_; }
  const MatrixXd& shape() const { return shape_; }
  const MatrixXd& left() const { return left_; }
  const VectorXd& floor() const { return floor_; }
  double width(Eigen::Index c, double deviation, double largest_deviation) const {
    return std::hypot(deviation, std::max(counts_[c], kFlattest * largest_deviation));
  }
  double deviation(Eigen::Index c, Eigen::Index k) const { return deviation_(c, k); }

  // Returns the derivatives of all channels by the parameters, which also move the state and the torque.
  MatrixXd gradient(Eigen::Index k) const {
    const auto at = static_cast<std::size_t>(k);
    const auto count = static_cast<Eigen::Index>(uncertainty_.names.size());
    MatrixXd slopes(channels_.count(), count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double step = kStep * uncertainty_.standard_error(static_cast<std::size_t>(i));
      slopes.col(i) = (moved(at, i, step) - moved(at, i, -step)) / (2 * step);
    }
    for (Eigen::Index c = 0; c < channels_.count(); ++c) {  // a speed has a corner at rest
      const Channel& channel = channels_.all()[static_cast<std::size_t>(c)];
      if (channel.kind != Channel::Kind::kLimit || !kLimitNames[channel.index].quantity->squared) continue;
      slopes.row(c) *= planned_(c, k) / std::max(planned_(c, k), kSlowTip);
    }
    return slopes;
  }

 private:
  static constexpr double kStep = 0.01;  // of a standard error

  VectorXd moved(std::size_t at, Eigen::Index i, double step) const {
    Parameters arm = robot_;
    *parameter_named(arm, uncertainty_.names[static_cast<std::size_t>(i)]) += step;
    Sample sample = plan_[at];
    for (Eigen::Index row = 0; row < kStates; ++row) {
      sample.state[static_cast<std::size_t>(row)] += step * sensitivities_.state[at](row, i);
    }
    for (std::size_t j = 0; j < kJoints; ++j) {
      sample.torque[j] += step * sensitivities_.torque[at](static_cast<Eigen::Index>(j), i);
    }
    return channels_.values(arm, sample);
  }

  // Adds the deviations that encoder counts and ticks cause for the robot itself.
  void add_counts() {
    VectorXd largest = VectorXd::Zero(channels_.count());
    follow_arm(robot_, robot_, trajectory_, channels_, [&](std::size_t tick, const VectorXd& values) {
      largest = largest.cwiseMax((values - planned_.col(static_cast<Eigen::Index>(tick))).cwiseAbs());
    });
    counts_ = (largest / kPeakOfCounts).cwiseMax(1e-12);
    floor_ = counts_.cwiseMax(kFlattest * deviation_.rowwise().maxCoeff());
    shape_ = (deviation_.array().square().colwise() + floor_.array().square()).sqrt();
  }

  void look_between() {
    left_ = MatrixXd::Constant(channels_.count(), ticks(), kNoLimit);
    Interpolator plan(trajectory_);
    double before = trajectory_.start_time();
    for (Eigen::Index k = 0; k < ticks(); ++k) {
      for (int look = 1; look <= kLooks; ++look) {
        const Sample at = plan.at(before + (time(k) - before) * look / kLooks);
        const VectorXd values = channels_.values(robot_, at);
        for (Eigen::Index c = 0; c < channels_.count(); ++c) {
          left_(c, k) = std::min(left_(c, k), channels_.left(c, values[c]));
        }
      }
      before = time(k);
    }
  }

  const Parameters& robot_;
  const Trajectory& trajectory_;
  const Channels& channels_;
  const Uncertainty& uncertainty_;
  std::vector<Sample> plan_;
  Sensitivities sensitivities_;
  MatrixXd planned_, deviation_, shape_, left_;
  VectorXd counts_, floor_;
};

// Draws arms, as columns of independent normal numbers.
MatrixXd draw(Eigen::Index directions, Eigen::Index arms, std::uint64_t seed) {
  Normal normal(seed);
  MatrixXd drawn(directions, arms);
  for (Eigen::Index n = 0; n < drawn.cols(); ++n) {
    for (Eigen::Index i = 0; i < directions; ++i) drawn(i, n) = normal();
  }
  return drawn;
}

// Returns the largest value after leaving out the `outside` largest ones.
double upper(std::vector<double> values, std::size_t outside) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(outside), values.end(),
                   std::greater<>());
  return values[outside];
}

// Returns the largest deviation of each channel (row) and arm (column) at any tick, in standard deviations there;
// infinite if an arm cannot be followed.
MatrixXd largest_deviations(const Parameters& robot, const Trajectory& trajectory, const Channels& channels,
                            const ExpectedMotion& motion, const Uncertainty& uncertainty, const MatrixXd& errors,
                            const ForEach& for_each, const std::function<bool()>& stopped) {
  MatrixXd found = MatrixXd::Constant(channels.count(), errors.cols(), kNoLimit);
  for_each(static_cast<std::size_t>(errors.cols()), [&](std::size_t n) {
    if (stopped()) return;
    const auto column = static_cast<Eigen::Index>(n);
    VectorXd largest = VectorXd::Zero(channels.count());
    const auto observe = [&](std::size_t tick, const VectorXd& values) {
      const auto k = static_cast<Eigen::Index>(tick);
      largest = largest.cwiseMax((values - motion.planned().col(k)).cwiseAbs().cwiseQuotient(motion.shape().col(k)));
    };
    const Parameters arm = changed(robot, uncertainty.names, errors.col(column));
    if (follow_arm(robot, arm, trajectory, channels, observe) && largest.allFinite()) found.col(column) = largest;
  });
  return found;
}

// Returns the largest deviation of each channel over the arms that could be followed; at least one standard deviation.
VectorXd widest_finite(const MatrixXd& deviations) {
  VectorXd widest = VectorXd::Ones(deviations.rows());
  for (const auto& arm : deviations.colwise()) {
    if (arm.allFinite()) widest = widest.cwiseMax(arm);
  }
  return widest;
}

// Returns the largest deviation of each arm over all channels to first order, without counts, at some of the ticks.
std::vector<double> first_order_scores(const Channels& channels, const ExpectedMotion& motion, const MatrixXd& errors) {
  const Eigen::Index step = std::max<Eigen::Index>(1, motion.ticks() / static_cast<Eigen::Index>(kMostPoints));
  VectorXd largest = VectorXd::Zero(errors.cols());
  for (Eigen::Index k = step - 1; k < motion.ticks(); k += step) {
    const MatrixXd deviations = motion.gradient(k) * errors;
    for (Eigen::Index c = 0; c < channels.count(); ++c) {
      const double sigma = motion.deviation(c, k);
      if (sigma > 0) largest = largest.cwiseMax(deviations.row(c).transpose().cwiseAbs() / sigma);
    }
  }
  return {largest.begin(), largest.end()};
}

std::string whose(const Robustness::Margin& m) {
  if (m.joint == 0) return m.name;
  return fmt::format("{} of {} {}", m.name, m.limit < kNoLimit ? "joint" : "link", m.joint);
}

std::vector<double> thinned(const MatrixXd& of, Eigen::Index row, Eigen::Index step, double factor) {
  std::vector<double> points;
  for (Eigen::Index first = 0; first < of.cols(); first += step) {
    const Eigen::Index size = std::min(step, of.cols() - first);
    points.push_back(factor * of.row(row).segment(first, size).maxCoeff());
  }
  return points;
}

// Returns the part of the variance of a deviation with these slopes that each parameter explains, and that knowing it
// exactly would take away: with errors e and a deviation s^T e, cov(s^T e, e_i)^2 / var e_i.
VectorXd explained(const Uncertainty& uncertainty, const VectorXd& slopes) {
  return (uncertainty.covariance * slopes).array().square() / uncertainty.covariance.diagonal().array();
}

class Judge {
 public:
  // factors: factor of each channel from its standard deviation to its tube.
  Judge(const Channels& channels, const ExpectedMotion& motion, const Uncertainty& uncertainty, const VectorXd& factors,
        Robustness& result)
      : channels_(channels),
        motion_(motion),
        uncertainty_(uncertainty),
        factors_(factors),
        result_(result),
        costs_(VectorXd::Zero(static_cast<Eigen::Index>(uncertainty.names.size()))) {}

  void judge() {
    const Eigen::Index step =
        (motion_.ticks() + static_cast<Eigen::Index>(kMostPoints) - 1) / static_cast<Eigen::Index>(kMostPoints);
    for (Eigen::Index first = 0; first < motion_.ticks(); first += step) {
      const Eigen::Index last = std::min(first + step, motion_.ticks()) - 1;
      result_.times.push_back(motion_.time(last));
      told_.emplace_back(last, motion_.gradient(last));
    }
    for (Eigen::Index c = 0; c < channels_.count(); ++c) {
      const Channel& channel = channels_.all()[static_cast<std::size_t>(c)];
      std::vector<double> tube = thinned(motion_.shape(), c, step, factors_[c]);
      if (channel.kind == Channel::Kind::kLink) {
        result_.link[channel.index] = factors_[c] * motion_.shape().row(c).maxCoeff();
        result_.link_tube[channel.index] = std::move(tube);
        continue;
      }
      Robustness::Margin margin = margin_of(c);
      margin.tube = std::move(tube);
      margin.halved = halved(c);
      (channel.kind == Channel::Kind::kTask ? result_.task : result_.limits).push_back(std::move(margin));
    }
    rank_costs();
    conclude();
  }

 private:
  // Returns how much narrower a channel's tube would be, at the reported times, if one parameter after the other had
  // half its error, which takes away three quarters of the variance that it explains.
  std::vector<std::vector<double>> halved(Eigen::Index c) const {
    constexpr double kOfHalf = 0.75;
    const auto count = static_cast<Eigen::Index>(uncertainty_.names.size());
    MatrixXd left(count, static_cast<Eigen::Index>(told_.size()));  // deviations with half of one error each
    VectorXd now(left.cols());
    for (Eigen::Index t = 0; t < left.cols(); ++t) {
      const auto& [k, gradient] = told_[static_cast<std::size_t>(t)];
      now[t] = motion_.deviation(c, k);
      const VectorXd less = kOfHalf * explained(uncertainty_, gradient.row(c).transpose());
      left.col(t) = (now[t] * now[t] - less.array()).max(0).sqrt();
    }
    std::vector<std::vector<double>> narrower(static_cast<std::size_t>(count));
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index t = 0; t < left.cols(); ++t) {
        const double before = motion_.width(c, now[t], now.maxCoeff());
        const double after = motion_.width(c, left(i, t), left.row(i).maxCoeff());
        narrower[static_cast<std::size_t>(i)].push_back(factors_[c] * (before - after));
      }
    }
    return narrower;
  }

  Robustness::Margin margin_of(Eigen::Index c) {
    const Channel& channel = channels_.all()[static_cast<std::size_t>(c)];
    Eigen::Index tightest = 0;
    (motion_.left().row(c) - factors_[c] * motion_.shape().row(c)).minCoeff(&tightest);
    Robustness::Margin m;
    m.name = channel.name;
    m.joint = channel.joint;
    m.index = channel.kind == Channel::Kind::kTask ? kLimits + channel.index : channel.index;
    m.unit = channel.unit;
    m.limit = channel.limit;
    m.factor = factors_[c];
    m.needed = factors_[c] * motion_.shape()(c, tightest);
    m.there = motion_.left()(c, tightest);
    m.time = motion_.time(tightest);
    m.passed = m.needed <= m.there;
    const VectorXd parts = explained(uncertainty_, motion_.gradient(tightest).row(c).transpose());
    const double all = motion_.shape()(c, tightest) * motion_.shape()(c, tightest);
    Eigen::Index largest = 0;
    m.fraction = parts.maxCoeff(&largest) / all;
    if (parts[largest] > motion_.floor()[c] * motion_.floor()[c]) {
      m.parameter = uncertainty_.names[static_cast<std::size_t>(largest)];
    }
    // A margin that is small compared with what is available costs nothing.
    const double weight = std::isfinite(m.needed) ? m.needed / std::max(m.needed, m.there) : 0;
    costs_ += weight * weight / all * parts;
    weights_ += weight * weight;
    return m;
  }

  void rank_costs() {
    for (std::size_t i = 0; i < uncertainty_.names.size(); ++i) {
      result_.costs.emplace_back(uncertainty_.names[i],
                                 costs_[static_cast<Eigen::Index>(i)] / std::max(weights_, 1e-300));
    }
    std::stable_sort(result_.costs.begin(), result_.costs.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
  }

  void conclude() {
    result_.kept = factors_.allFinite();
    if (!result_.kept) {
      result_.reason =
          "more of the drawn arms than may be left out diverge or saturate their drives, so no margin can be stated";
      return;
    }
    const Robustness::Margin* worst = nullptr;
    for (const auto* margins : {&result_.limits, &result_.task}) {
      for (const Robustness::Margin& m : *margins) {
        if (m.passed) continue;
        if (worst == nullptr || m.there / m.needed < worst->there / worst->needed) worst = &m;
      }
    }
    if (worst == nullptr) return;
    result_.kept = false;
    result_.reason = fmt::format(
        "{} needs a margin of {:.3g} {} for a probability of {}, and has {:.3g} {} at {:.6f} s", whose(*worst),
        worst->needed, worst->unit, result_.confidence, worst->there, worst->unit, worst->time);
  }

  const Channels& channels_;
  const ExpectedMotion& motion_;
  const Uncertainty& uncertainty_;
  const VectorXd& factors_;
  Robustness& result_;
  std::vector<std::pair<Eigen::Index, MatrixXd>> told_;  // ticks at which tubes are reported, and the slopes there
  VectorXd costs_;
  double weights_ = 0;
};

}  // namespace

// Returns the least N such that it is improbable that of N draws kOutside or fewer lie outside if the fraction inside
// is less than `confidence`: sum over k <= kOutside of (N over k) (1-c)^k c^(N-k) <= 1 - kCertainty (Wilks, Ann. Math.
// Stat. 12, 1941).
Draws draws_for(double confidence) {
  for (std::size_t arms = kOutside + 1;; ++arms) {
    double improbable = 0, term = std::pow(confidence, static_cast<double>(arms));
    for (std::size_t k = 0; k <= kOutside; ++k) {
      improbable += term;
      term *= static_cast<double>(arms - k) / static_cast<double>(k + 1) * (1 - confidence) / confidence;
    }
    if (improbable <= 1 - kCertainty) return {arms, kOutside};
  }
}

Robustness robustness(const Parameters& robot, const Limits& limits, const TaskOfMotion& task,
                      const Trajectory& trajectory, double confidence, const ForEach& for_each,
                      const std::function<bool()>& stopped, std::uint64_t seed) {
  const Uncertainty uncertainty = uncertainty_of(robot);
  if (uncertainty.none()) {
    throw InputError("robot", "standard_error",
                     "nothing is uncertain: neither covariance nor standard errors of link, spring, motor, friction or "
                     "payload are given, and a probability needs some");
  }
  const MatrixXd factor = uncertainty.factor();
  const Channels channels(robot, limits, task);
  const ExpectedMotion motion(robot, trajectory, channels, uncertainty);
  const Draws draws = draws_for(confidence);
  const auto arms = static_cast<Eigen::Index>(draws.arms);
  const MatrixXd drawn = draw(factor.cols(), arms + kScouts, seed), errors = factor * drawn;
  const MatrixXd largest =
      largest_deviations(robot, trajectory, channels, motion, uncertainty, errors, for_each, stopped);
  if (stopped()) return {};
  const VectorXd scouted = widest_finite(largest.rightCols(kScouts));
  const VectorXd scores = (largest.leftCols(arms).array().colwise() / scouted.array()).colwise().maxCoeff().transpose();

  Robustness r;
  r.evaluated = true;
  r.confidence = confidence;
  r.certainty = kCertainty;
  r.arms = draws.arms;
  r.parameters = uncertainty.names.size();
  r.names = uncertainty.names;
  r.directions = static_cast<std::size_t>(factor.cols());
  const VectorXd factors = scouted * upper({scores.begin(), scores.end()}, draws.outside);
  r.first_order = upper(first_order_scores(channels, motion, errors.leftCols(arms)), draws.outside);
  const VectorXd radii = drawn.leftCols(arms).colwise().norm();
  r.ellipsoid = upper({radii.begin(), radii.end()}, draws.outside);
  Judge(channels, motion, uncertainty, factors, r).judge();
  return r;
}

void demand_robustness(const Parameters& robot, const Limits& limits, const TaskOfMotion& task,
                       const Trajectory& trajectory, double confidence, Certificate& certificate,
                       const ForEach& for_each) {
  certificate.robustness = robustness(robot, limits, task, trajectory, confidence, for_each);
  if (certificate.robustness.kept) return;
  certificate.certified = false;
  certificate.failures.push_back(certificate.robustness.reason);
}

Trial try_arm(const Parameters& robot, const Limits& limits, const TaskOfMotion& task, const Trajectory& trajectory,
              const Parameters& arm) {
  const Channels channels(robot, limits, task);
  const std::vector<Sample> plan = plan_at_ticks(trajectory);
  Trial trial;
  bool kept = true;
  const bool completed = follow_arm(robot, arm, trajectory, channels, [&](std::size_t tick, const VectorXd& values) {
    for (Eigen::Index c = 0; c < channels.count(); ++c) {
      const Channel& channel = channels.all()[static_cast<std::size_t>(c)];
      if (channel.kind == Channel::Kind::kLink) {
        double& largest = trial.link[channel.index];
        largest = std::max(largest, std::abs(values[c] - plan[tick].state.q[channel.index]));
      } else {
        kept = kept && channels.left(c, values[c]) >= 0;
      }
    }
  });
  trial.kept = completed && kept;
  return trial;
}

}  // namespace fjr
