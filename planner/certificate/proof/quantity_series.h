// The limited quantities along a motion, as polynomials with rigorous coefficients.
#pragma once

#include <vector>

#include "common/enclosure/taylor.h"
#include "planner/certificate/proof/row_polynomials.h"
#include "planner/problem/quantities.h"

namespace fjr {

// Polynomials of the state and the torque over a time: `near` of the time since its beginning, the last coefficients of
// which may hold a remainder; `over`: Taylor coefficients at any of its instants.
struct AlongState {
  State<enclosure::Polynomial> near, over;
  Joints<enclosure::Polynomial> torque_near, torque_over;
};

class QuantitySeries {
 public:
  // Of the quantities that `which` chooses by their QuantityInfo and that `limits` limits. order: of their polynomials,
  // the last coefficient of which holds the remainder.
  template <class Which>
  QuantitySeries(const Parameters& robot, const Limits& limits, std::size_t order, const Which& which);

  // Index in kLimitNames of each.
  const std::vector<std::size_t>& limits() const { return limits_; }
  // Their values() along that, squared for those that are.
  const std::vector<enclosure::Polynomial>& along(const AlongState& motion);

 private:
  static void set_inputs(enclosure::Series& series, const State<enclosure::Polynomial>& x,
                         const Joints<enclosure::Polynomial>& torque, std::size_t order);

  enclosure::Recording recording_{kStates + kJoints};
  std::vector<std::size_t> limits_;
  std::size_t order_;
  std::vector<enclosure::Series> near_, over_;  // of one each, made when the recording is complete
  std::vector<enclosure::Polynomial> values_;
};

// ---- details of templates ----

template <class Which>
QuantitySeries::QuantitySeries(const Parameters& robot, const Limits& limits, std::size_t order, const Which& which)
    : order_(order) {
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
  near_.emplace_back(recording_, order);
  over_.emplace_back(recording_, order);
  values_.assign(limits_.size(), enclosure::Polynomial(order + 1));
}

}  // namespace fjr
