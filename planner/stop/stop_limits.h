// What a controlled stop is limited by: every quantity that robot.yaml limits. Limits of a request are on its plan.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "planner/problem/quantities.h"

namespace fjr {

// Returns the limits of a stop. They are wider than those of a plan, because a stop may begin where the plan is at its
// limits, and its torque must be continuous there. Where the drive has more than the plan may use, half of the
// difference is for the stop (the other half is left to feedback); motor velocities may be 5 % higher, and deflections
// 1 %, up to which the identified stiffness is valid (QuantityInfo::in_stop). Position limits stay, because there may
// be a wall.
Limits stop_limits(const Parameters& robot);

constexpr bool is_kept_by_stops(const QuantityInfo& quantity) { return quantity.of_robot != nullptr; }

// The quantities that stops keep, and the number of their limits; all of them are limited per joint.
inline constexpr std::size_t kStopQuantities = [] {
  return static_cast<std::size_t>(std::count_if(Quantities::infos.begin(), Quantities::infos.end(), is_kept_by_stops));
}();
inline constexpr std::size_t kStopLimits = kStopQuantities * kJoints;

// One number per limit that stops keep: those of the first joint in the order of the list, then those of the next.
using PerStopLimit = std::array<double, kStopLimits>;

inline constexpr std::array<LimitName, kStopLimits> kStopLimitNames = [] {
  std::array<LimitName, kStopLimits> names{};
  std::size_t next = 0;
  for (int joint = 1; joint <= kJoints; ++joint) {
    for (const LimitName& name : kLimitNames) {
      if (name.joint == joint && is_kept_by_stops(*name.quantity)) names[next++] = name;
    }
  }
  return names;
}();

inline PerStopLimit in_order(const Limits& limits) {
  PerStopLimit values{};
  std::transform(kStopLimitNames.begin(), kStopLimitNames.end(), values.begin(),
                 [&](const LimitName& name) { return name.in(limits); });
  return values;
}

// Returns the limited values, with their signs. The search for stops calls it thousands of times and the executor calls
// it in a control tick, so it does not allocate.
inline PerStopLimit stop_values(const Parameters& robot, const State<double>& x, const Joints<double>& torque) {
  constexpr Joints<double> kNoRate{};
  const Moment<double> now{robot, x, torque, kNoRate};
  PerStopLimit values{};
  std::size_t next = 0;
  Quantities::visit([&](auto quantity) {
    if constexpr (is_kept_by_stops(quantity.info)) {
      static_assert(quantity.info.count() == kJoints && !quantity.info.squared,
                    "stops have no limits of this kind yet");
      const Joints<double> of_joints = quantity.value(now);
      for (std::size_t j = 0; j < kJoints; ++j) values[j * kStopQuantities + next] = of_joints[j];
      ++next;
    }
  });
  return values;
}

}  // namespace fjr
