// The polynomials q(s), s in [0, 1], from given derivatives to rest, among which stops are searched.
#pragma once

#include <array>
#include <vector>

#include "model/flatness.h"
#include "planner/stop/stop.h"

namespace fjr {

// The polynomial of one joint [rad]. free[0] is q(1) - q(0). The others are the weights of the bumps s^5 (1-s)^5
// P_i(2s-1) with the Legendre polynomials P_i, scaled to a size of about 1. If they are all zero, the polynomial has
// degree 9.
struct StopShape {
  std::array<double, 5> start{};  // q and its derivatives in s
  std::array<double, kShapes> free{};
};

using Derivatives = std::array<double, 5>;  // q, dq/ds, ... at some s

// The basis polynomials tabulated at the nodes s that the search evaluates repeatedly. These are Chebyshev nodes, which
// are dense at both ends, where the polynomials vary most.
class ShapeTable {
 public:
  explicit ShapeTable(int nodes);  // node 0: s = 0; node `nodes`: s = 1

  Derivatives at(const StopShape& shape, int node) const;

 private:
  struct Row {
    std::array<std::array<double, 5>, 5 + kShapes> value;  // per basis polynomial: its value and four derivatives
  };
  std::vector<Row> rows_;
};

Derivatives evaluate(const StopShape& shape, double s);

// Converts derivatives by s to derivatives by time, for a stop of this duration [s].
LinkMotion in_time(const Joints<Derivatives>& derivatives, double duration);

// Returns the shapes that begin with this link motion, with all free parameters zero. duration: [s].
Joints<StopShape> shapes_from(const LinkMotion& motion, double duration);

}  // namespace fjr
