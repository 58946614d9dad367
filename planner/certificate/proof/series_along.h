// A recorded function along a motion, as polynomials over time with rigorous coefficients.
#pragma once

#include <vector>

#include "common/enclosure/flow.h"
#include "common/enclosure/taylor.h"

namespace fjr {

class SeriesAlong {
 public:
  // function: complete; it outlives this. order: of the polynomials, the last coefficient of which holds the remainder.
  SeriesAlong(const enclosure::Recording& function, std::size_t order);

  // Sets an input over a time interval. near: polynomial of the time since its beginning, whose last coefficients may
  // hold a remainder; over: Taylor coefficients at any instant of the interval.
  void set(std::size_t input, const enclosure::Polynomial& near, const enclosure::Polynomial& over);
  // Returns the function's outputs; all inputs have to be set.
  const std::vector<enclosure::Polynomial>& values();

 private:
  std::size_t order_;
  enclosure::Series near_, over_;
  std::vector<enclosure::Polynomial> values_;
};

}  // namespace fjr
