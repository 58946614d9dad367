#include "planner/request/check_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "common/dual.h"
#include "model/dynamics.h"
#include "planner/problem/quantities.h"

namespace fjr {
namespace {

// The parts of a Moment. A Pattern of them tells which of them a quantity depends on.
enum Part { kPartQ, kPartDq, kPartTheta, kPartDtheta, kPartTorque, kPartTorqueRate, kParts };
using PartPattern = Pattern<kParts>;

template <class Quantity>
PartPattern parts_of(Quantity quantity, const Parameters& robot) {
  const auto both_joints = [](Part part) {
    return Joints<PartPattern>{PartPattern::input(1, part), PartPattern::input(1, part)};
  };
  const State<PartPattern> x{both_joints(kPartQ), both_joints(kPartDq), both_joints(kPartTheta),
                             both_joints(kPartDtheta)};
  const Joints<PartPattern> torque = both_joints(kPartTorque), torque_rate = both_joints(kPartTorqueRate);
  PartPattern all;
  for (const auto& value : quantity.value(Moment<PartPattern>{robot, x, torque, torque_rate})) all = all + value;
  return all;
}

bool is_known(const PartPattern& parts, const KnownState& state) {
  return (state.dq || !parts.depends_on(kPartDq)) && (state.theta || !parts.depends_on(kPartTheta)) &&
         (state.dtheta || !parts.depends_on(kPartDtheta)) && (state.at_rest || !parts.depends_on(kPartTorque)) &&
         !parts.depends_on(kPartTorqueRate);
}

// Returns the part of the request that decides a quantity. What was not given of the motors follows from q and dq, and
// the torque at rest from q alone.
Place named_for(const PartPattern& parts, const StatePlace& state) {
  if (parts.depends_on(kPartTorque)) return state.place.first_of({{"q", state.q}});
  return state.place.first_of({{"theta", state.theta && parts.depends_on(kPartTheta)},
                               {"dtheta", state.dtheta && parts.depends_on(kPartDtheta)},
                               {"dq", state.dq},
                               {"q", state.q}});
}

// Returns a note on the payload, for messages about quantities that it contributes to.
std::string with_load(const Problem& problem) {
  const double mass = problem.robot.payload.mass;
  return mass > 0 ? fmt::format(" with the payload of {} kg", mass) : "";
}

// Returns the message about joint index j (of the tip: 0).
std::string exceeds(const QuantityInfo& info, std::size_t j, double reached, const PartPattern& parts,
                    const Problem& problem, const State<double>& x) {
  const double limit = info.in(problem.limits, j);
  const std::string joint = info.of_tip ? "" : fmt::format("joint {}: ", j + 1);
  const std::string words = info.at_state != nullptr ? info.at_state : fmt::format("{} would be", info.name);
  // The payload deflects the springs, and the motors carry it.
  const bool loaded = parts.depends_on(kPartTheta) || parts.depends_on(kPartTorque);
  const bool is_angle = same_quantity(info, SpringDeflection::info);  // the motor's angle is within the limit of q
  return fmt::format("{}{} {:.6g} {}{}, above the limit of {} {}{}", joint, words, reached, info.unit,
                     loaded ? with_load(problem) : "", limit, info.unit,
                     is_angle ? degrees_suspected(x.theta[j], x.q[j] - limit, x.q[j] + limit) : "");
}

}  // namespace

void check_state(const StatePlace& place, const Problem& problem, const KnownState& state) {
  constexpr Joints<double> kUnused{};
  const State<double> x{state.q, state.dq.value_or(kUnused), state.theta.value_or(kUnused),
                        state.dtheta.value_or(kUnused)};
  const Joints<double> torque = state.at_rest ? gravity_torque(problem.robot, state.q) : kUnused;
  std::optional<Place> named;
  std::string message;
  Quantities::visit([&](auto quantity) {
    const QuantityInfo& info = quantity.info;
    const PartPattern parts = parts_of(quantity, problem.robot);
    if (same_quantity(info, LinkPosition::info) || !is_known(parts, state)) return;
    const auto values = quantity.value(Moment<double>{problem.robot, x, torque, kUnused});
    for (std::size_t j = 0; j < values.size(); ++j) {
      const double reached = info.magnitude(values[j]);
      if (reached <= info.in(problem.limits, j)) continue;
      // Of several quantities the last one is told. The list begins with the torque; a torque at rest is what follows
      // least directly from what was asked for.
      named.emplace(named_for(parts, place));
      message = exceeds(info, j, reached, parts, problem, x);
      return;
    }
  });
  if (named) named->fail(message);
}

void check_holding_somewhere(const Place& place, const Problem& problem, const Goal& goal) {
  constexpr int kAngles = 2000;
  const std::size_t free = goal.free[0] ? 0 : 1, given = 1 - free;
  Joints<double> q = goal.q;
  double least = kNoLimit, least_of_free = kNoLimit;  // [N m] of the joint that is given, and of the other one
  for (int i = 0; i <= kAngles; ++i) {
    q[free] = std::lerp(problem.limits.lowest(free), problem.limits.highest(free), i / double{kAngles});
    const Joints<double> gravity = gravity_torque(problem.robot, q);
    least_of_free = std::min(least_of_free, std::abs(gravity[free]));
    if (std::abs(gravity[free]) <= problem.limits.torque[free]) least = std::min(least, std::abs(gravity[given]));
  }
  if (least <= problem.limits.torque[given]) return;
  if (std::isinf(least)) {
    place.at("q").fail(
        fmt::format("joint {}: holding still takes at least {:.6g} N m{}, wherever it is, above the limit "
                    "of {} N m",
                    free + 1, least_of_free, with_load(problem), problem.limits.torque[free]));
  }
  place.at("q").fail(
      fmt::format("joint {}: holding still here takes at least {:.6g} N m{}, wherever joint {} is, above "
                  "the limit of {} N m",
                  given + 1, least, with_load(problem), free + 1, problem.limits.torque[given]));
}

}  // namespace fjr
