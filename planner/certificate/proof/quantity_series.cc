#include "planner/certificate/proof/quantity_series.h"

namespace fjr {

const std::vector<enclosure::Polynomial>& QuantitySeries::along(const AlongState& motion) {
  for (std::size_t i = 0; i < kStates; ++i) series_->set(i, motion.near[i], motion.over[i]);
  for (std::size_t j = 0; j < kJoints; ++j) series_->set(kStates + j, motion.torque_near[j], motion.torque_over[j]);
  return series_->values();
}

}  // namespace fjr
