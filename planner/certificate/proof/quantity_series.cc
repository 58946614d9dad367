#include "planner/certificate/proof/quantity_series.h"

namespace fjr {

void QuantitySeries::set_inputs(enclosure::Series& series, const State<enclosure::Polynomial>& x,
                                const Joints<enclosure::Polynomial>& torque, std::size_t order) {
  const auto set = [&](std::size_t input, const enclosure::Polynomial& c) {
    for (std::size_t k = 0; k <= order; ++k) series.at(input, k) = k < c.size() ? c[k] : enclosure::Ball{};
  };
  for (std::size_t i = 0; i < kStates; ++i) set(i, x[i]);
  for (std::size_t j = 0; j < kJoints; ++j) set(kStates + j, torque[j]);
  for (std::size_t k = 0; k <= order; ++k) series.compute(k);
}

const std::vector<enclosure::Polynomial>& QuantitySeries::along(const AlongState& motion) {
  enclosure::Series &near = near_.front(), &over = over_.front();
  set_inputs(near, motion.near, motion.torque_near, order_ - 1);
  set_inputs(over, motion.over, motion.torque_over, order_);
  for (std::size_t i = 0; i < limits_.size(); ++i) {
    for (std::size_t k = 0; k < order_; ++k) values_[i][k] = near.output(i, k);
    values_[i][order_] = over.output(i, order_);
  }
  return values_;
}

}  // namespace fjr
