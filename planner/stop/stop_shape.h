// Polynomials q(s), s in [0, 1], from given derivatives to rest: the family in which stops are looked for.
#pragma once

#include <array>
#include <vector>

#include "model/flatness.h"
#include "planner/stop/stop.h"

namespace fjr {

// Of one joint; [rad]. free[0] is q at the end beyond q at the start; the others weigh the bumps s^5 (1-s)^5 P_i(2s-1),
// P_i the Legendre polynomials, scaled to about 1: all zero is the polynomial of degree 9.
struct StopShape {
  std::array<double, 5> start{};  // q and its derivatives in s
  std::array<double, kShapes> free{};
};

using Derivatives = std::array<double, 5>;  // q, dq/ds, ... at some s

// A basis tabulated, because the search looks at the same s again and again: Chebyshev's, dense at both ends, where
// polynomials are liveliest.
class ShapeTable {
 public:
  explicit ShapeTable(int nodes);  // node 0: s = 0; node `nodes`: s = 1

  Derivatives at(const StopShape& shape, int node) const;

 private:
  struct Row {
    std::array<std::array<double, 5>, 5 + kShapes> value;  // of each basis polynomial: itself and its derivatives
  };
  std::vector<Row> rows_;
};

Derivatives evaluate(const StopShape& shape, double s);

// `derivatives` in s at the duration `duration` [s], as derivatives in time.
LinkMotion in_time(const Joints<Derivatives>& derivatives, double duration);

// From a link motion, all free numbers zero.
Joints<StopShape> shapes_from(const LinkMotion& motion, double duration);

}  // namespace fjr
