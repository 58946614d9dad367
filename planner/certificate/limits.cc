#include "planner/certificate/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "model/friction.h"
#include "planner/certificate/thresholds.h"
#include "planner/problem/problem.h"

namespace fjr {
namespace {

struct Extreme {
  double magnitude = 0, time = 0;
  void include(double value, double at) {
    if (!(value > magnitude)) return;
    magnitude = value;
    time = at;
  }
};
using PerIndex = std::array<double, kLimits>;

constexpr bool is_polynomial(const QuantityInfo& quantity) { return quantity.degree > 0; }
constexpr bool is_sampled(const QuantityInfo& quantity) {
  return quantity.degree == 0 && quantity.bound != BoundOn::kControl;
}

// The cubic v0 + c s + b s^2 + a s^3 through four values, at s = 0, 1/3, 2/3 and 1.
struct Cubic {
  double v0, a, b, c;

  explicit Cubic(const std::array<double, 4>& v)
      : v0(v[0]),
        a(4.5 * (v[3] - v[0] + 3 * (v[1] - v[2]))),
        b(4.5 * (2 * v[0] - 5 * v[1] + 4 * v[2] - v[3])),
        c(0.5 * (-11 * v[0] + 18 * v[1] - 9 * v[2] + 2 * v[3])) {}

  double value(double s) const { return v0 + s * (c + s * (b + s * a)); }
  // Zeros of the slope 3 a s^2 + 2 b s + c, without cancellation; NaN or infinite where there is none.
  std::array<double, 2> stationary() const {
    const double root = -(b + std::copysign(std::sqrt(b * b - 3 * a * c), b));
    return {root / (3 * a), c / root};
  }
};

// Largest magnitudes of what is limited over the rows and the interpolation between them.
class PublishedExtremes {
 public:
  PublishedExtremes(const Parameters& robot, const Limits& limits, const Trajectory& trajectory)
      : robot_(robot), limits_(limits), rows_(trajectory.samples), plan_(trajectory) {
    polynomials();
    const auto sampled = [this](const QuantityInfo& q) { return is_sampled(q) && is_limited(q, limits_); };
    if (std::any_of(Quantities::infos.begin(), Quantities::infos.end(), sampled)) {
      samples(comparison_instants(trajectory));
    }
    if (is_limited(LimitedTorqueRate::info, limits)) torque_rates();
  }

  const Extreme& operator[](std::size_t limit) const { return extremes_[limit]; }

 private:
  // Returns the values of those limited quantities that `which` chooses.
  template <class Which>
  PerIndex values_at(const Sample& sample, const Which& which) const {
    PerIndex values{};
    std::size_t next = 0;
    const Joints<double> no_rate{};
    Quantities::visit([&](auto quantity) {
      if (which(quantity.info) && is_limited(quantity.info, limits_)) {
        const auto of_joints = quantity.value(Moment<double>{robot_, sample.state, sample.torque, no_rate});
        std::copy(of_joints.begin(), of_joints.end(), values.begin() + next);
      }
      next += quantity.info.count();
    });
    return values;
  }

  void include(std::size_t limit, double value, double time) {
    extremes_[limit].include(kLimitNames[limit].quantity->magnitude(value), time);
  }

  void polynomials() {
    PerIndex first = values_at(rows_.front(), is_polynomial);
    for (std::size_t k = 0; k + 1 < rows_.size(); ++k) {
      const double start = rows_[k].time, h = rows_[k + 1].time - start;
      const PerIndex second = values_at(plan_.at(start + h / 3), is_polynomial),
                     third = values_at(plan_.at(start + 2 * h / 3), is_polynomial),
                     last = values_at(rows_[k + 1], is_polynomial);
      for (std::size_t i = 0; i < kLimits; ++i) {
        include(i, first[i], start);
        include(i, last[i], rows_[k + 1].time);
        if (kLimitNames[i].quantity->degree < 2) continue;
        const Cubic cubic({first[i], second[i], third[i], last[i]});
        for (const double s : cubic.stationary()) {
          if (s > 0 && s < 1) include(i, cubic.value(s), start + s * h);
        }
      }
      first = last;
    }
  }

  void samples(const std::vector<double>& instants) {
    const auto include_all = [this](const Sample& sample) {
      const PerIndex values = values_at(sample, is_sampled);
      for (std::size_t i = 0; i < kLimits; ++i) {
        if (is_sampled(*kLimitNames[i].quantity)) include(i, values[i], sample.time);
      }
    };
    include_all(rows_.front());
    double before = rows_.front().time;
    for (const double time : instants) {  // velocities may be largest in between, however close rows are to each other
      include_all(plan_.at(std::midpoint(before, time)));
      include_all(plan_.at(time));
      before = time;
    }
  }

  void torque_rates() {
    for (std::size_t j = 0; j < kJoints; ++j) {
      const FrictionLaw law = FrictionLaw::of(robot_, static_cast<int>(j));
      std::vector<double> u;
      for (const Sample& row : rows_) u.push_back(row.torque[j] - law.nonlinear(row.state.dtheta[j]));
      const auto at = [&](const BetweenRows& b) {
        const double from = rows_[b.row].time, to = rows_[b.row + 1].time;
        if (b.time == from || b.time == to) return b.time == from ? u[b.row] : u[b.row + 1];
        return std::lerp(u[b.row], u[b.row + 1], (b.time - from) / (to - from));
      };
      each_pair_for_torque_rates(rows_, [&](const BetweenRows& earlier, const BetweenRows& later) {
        const double rate = (at(later) - at(earlier)) / (later.time - earlier.time);
        include(Quantities::first_limit<LimitedTorqueRate>() + j, rate, later.time);
      });
    }
  }

  const Parameters& robot_;
  const Limits& limits_;
  const std::vector<Sample>& rows_;
  Interpolator plan_;
  std::array<Extreme, kLimits> extremes_;
};

bool within(const LimitCheck& c, double allowed) {
  return c.reached <= c.limit * (1 + kPublishedFraction) && c.rollout <= allowed;
}

LimitCheck check(std::size_t index, double limit, double allowed, const Extreme& published, const Comparison& rollout) {
  const LimitName& name = kLimitNames[index];
  LimitCheck c{name.quantity->name, name.joint,          limit, published.magnitude,
               published.time,      published.magnitude, false, index};
  if (name.quantity->bound != BoundOn::kControl) c.rollout = name.in(rollout.peaks);
  c.passed = within(c, allowed);
  // An event is a violation however brief, even where no instant of comparison saw it.
  if (std::any_of(rollout.events.begin(), rollout.events.end(),
                  [&](const Event& e) { return e.exceeded == name.quantity && e.joint == name.joint; })) {
    c.passed = false;
    c.rollout = std::max(c.rollout, allowed);
  }
  return c;
}

}  // namespace

Limits rollout_allowance(const Parameters& p, const Limits& limits) {
  Limits allowed = limits;
  for (const LimitName& name : kLimitNames) {
    double& limit = name.in(allowed);
    switch (name.quantity->in_rollout) {
      case InRollout::kOfPlan:
        limit = kNoLimit;
        break;
      case InRollout::kVelocity:
        limit *= 1 + kRolloutVelocityFraction;
        break;
      case InRollout::kPosition:
        limit += exactness_tolerance(p);
        break;
    }
  }
  return allowed;
}

std::vector<LimitCheck> check_limits(const Parameters& p, const Limits& limits, const Trajectory& trajectory,
                                     const Comparison& rollout) {
  const Limits allowed = rollout_allowance(p, limits);
  const PublishedExtremes published(p, limits, trajectory);
  std::vector<LimitCheck> checks;
  for (const int joint : {1, 2, 0}) {
    for (std::size_t i = 0; i < kLimits; ++i) {
      const LimitName& name = kLimitNames[i];
      if (name.joint != joint || !std::isfinite(name.in(limits))) continue;
      checks.push_back(check(i, name.in(limits), name.in(allowed), published[i], rollout));
    }
  }
  return checks;
}

std::string counted_from(const LimitCheck& c, const Limits& limits) {
  const LimitName& name = kLimitNames[c.index];
  const double middle = name.joint == 0 ? 0 : name.quantity->counted_from(limits, name.j());
  return middle == 0 ? "" : fmt::format(", both counted from {:.6g}", middle);
}

std::string violation(const LimitCheck& c, const Limits& limits) {
  const std::string from = counted_from(c, limits);
  const std::string whose = c.joint > 0 ? fmt::format("{} of joint {}", c.name, c.joint) : c.name;
  if (c.reached > c.limit * (1 + kPublishedFraction)) {
    return fmt::format("{} reaches {:.9g} at {:.6f} s, its limit is {:.9g}{}", whose, c.reached, c.time, c.limit, from);
  }
  return fmt::format(
      "{} reaches {:.9g} in the closed-loop rollout, more than exactness explains; its limit is {:.9g}{}", whose,
      c.rollout, c.limit, from);
}

}  // namespace fjr
