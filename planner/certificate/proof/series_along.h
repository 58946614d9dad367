// A recorded function of what moves, as polynomials over time with rigorous coefficients.
#pragma once

#include <vector>

#include "common/enclosure/flow.h"
#include "common/enclosure/taylor.h"

namespace fjr {

class SeriesAlong {
 public:
  // function: complete; it outlives this. order: of the polynomials, the last coefficient of which holds the remainder.
  SeriesAlong(const enclosure::Recording& function, std::size_t order);

  // An input over a time: `near` of the time since its beginning, the last coefficients of which may hold a remainder;
  // `over`: its Taylor coefficients at any instant of that time.
  void set(std::size_t input, const enclosure::Polynomial& near, const enclosure::Polynomial& over);
  // The function's outputs, when all inputs are set.
  const std::vector<enclosure::Polynomial>& values();

 private:
  std::size_t order_;
  enclosure::Series near_, over_;
  std::vector<enclosure::Polynomial> values_;
};

}  // namespace fjr
