// The limited quantities along a motion, as polynomials with rigorous coefficients.
#pragma once

#include <optional>
#include <vector>

#include "planner/certificate/proof/row_polynomials.h"
#include "planner/certificate/proof/series_along.h"
#include "planner/problem/quantities.h"

namespace fjr {

// The state and the torque over a time, as SeriesAlong::set() takes them.
struct AlongState {
  State<enclosure::Polynomial> near, over;
  Joints<enclosure::Polynomial> torque_near, torque_over;
};

class QuantitySeries {
 public:
  // Records those quantities that `which` chooses by their QuantityInfo and that `limits` limits. order: of their
  // polynomials, whose last coefficient holds the remainder.
  template <class Which>
  QuantitySeries(const Parameters& robot, const Limits& limits, std::size_t order, const Which& which);

  // Index in kLimitNames of each.
  const std::vector<std::size_t>& limits() const { return limits_; }
  // Returns their values along the motion; squared ones as their squares.
  const std::vector<enclosure::Polynomial>& along(const AlongState& motion);

 private:
  enclosure::Recording recording_{kStates + kJoints};
  std::vector<std::size_t> limits_;
  std::optional<SeriesAlong> series_;  // made when the recording is complete
};

// ---- details of templates ----

template <class Which>
QuantitySeries::QuantitySeries(const Parameters& robot, const Limits& limits, std::size_t order, const Which& which) {
  State<enclosure::Active> x;
  for (std::size_t i = 0; i < kStates; ++i) x[i] = recording_.input(i);
  const Joints<enclosure::Active> torque{recording_.input(kStates), recording_.input(kStates + 1)}, no_rate{};
  std::size_t next = 0;
  Quantities::visit([&](auto quantity) {
    if (which(quantity.info) && is_limited(quantity.info, limits)) {
      const auto values = quantity.value(Moment<enclosure::Active>{robot, x, torque, no_rate});
      for (std::size_t j = 0; j < values.size(); ++j) {
        if (!(quantity.info.in(limits, j) < kNoLimit)) continue;
        recording_.output(values[j]);
        limits_.push_back(next + j);
      }
    }
    next += quantity.info.count();
  });
  series_.emplace(recording_, order);
}

}  // namespace fjr
