#include "planner/certificate/proof/series_along.h"

namespace fjr {
namespace {

void set_coefficients(enclosure::Series& series, std::size_t input, const enclosure::Polynomial& c, std::size_t order) {
  for (std::size_t k = 0; k <= order; ++k) series.at(input, k) = k < c.size() ? c[k] : enclosure::Ball{};
}

}  // namespace

SeriesAlong::SeriesAlong(const enclosure::Recording& function, std::size_t order)
    : order_(order),
      near_(function, order),
      over_(function, order),
      values_(function.outputs().size(), enclosure::Polynomial(order + 1)) {}

void SeriesAlong::set(std::size_t input, const enclosure::Polynomial& near, const enclosure::Polynomial& over) {
  set_coefficients(near_, input, near, order_ - 1);
  set_coefficients(over_, input, over, order_);
}

const std::vector<enclosure::Polynomial>& SeriesAlong::values() {
  for (std::size_t k = 0; k < order_; ++k) near_.compute(k);
  for (std::size_t k = 0; k <= order_; ++k) over_.compute(k);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    for (std::size_t k = 0; k < order_; ++k) values_[i][k] = near_.output(i, k);
    values_[i][order_] = over_.output(i, order_);
  }
  return values_;
}

}  // namespace fjr
