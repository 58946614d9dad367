#include "planner/certificate/proof/row_polynomials.h"

namespace fjr {
namespace {

using enclosure::Ball;
using enclosure::Polynomial;

// The cubic through x0 and x1 with slopes v0 and v1 at the ends of an interval of length h.
Polynomial cubic(const Ball& x0, const Ball& v0, const Ball& x1, const Ball& v1, const Ball& h) {
  const Ball secant = (x1 - x0) / h, curve0 = v0 - secant, curve1 = v1 - secant;
  return {x0, v0, -(2.0 * curve0 + curve1) / h, (curve0 + curve1) / (h * h)};
}

Polynomial derivative(const Polynomial& c) {
  Polynomial d;
  for (std::size_t k = 1; k < c.size(); ++k) d.push_back(c[k] * static_cast<double>(k));
  return d;
}

}  // namespace

RowPolynomials RowPolynomials::between(const Sample& from, const Sample& to) {
  RowPolynomials r;
  const Ball h = Ball(to.time) - Ball(from.time);
  r.duration = h;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const State<double>&a = from.state, &b = to.state;
    r.state.q[j] = cubic(a.q[j], a.dq[j], b.q[j], b.dq[j], h);
    r.state.theta[j] = cubic(a.theta[j], a.dtheta[j], b.theta[j], b.dtheta[j], h);
    r.state.dq[j] = derivative(r.state.q[j]);
    r.state.dtheta[j] = derivative(r.state.theta[j]);
    r.torque[j] = {from.torque[j], (Ball(to.torque[j]) - from.torque[j]) / h};
  }
  return r;
}

RowPolynomials RowPolynomials::shifted(const Ball& by) const {
  RowPolynomials r = *this;
  for (std::size_t i = 0; i < kStates; ++i) r.state[i] = enclosure::shifted(state[i], by);
  for (std::size_t j = 0; j < kJoints; ++j) r.torque[j] = enclosure::shifted(torque[j], by);
  return r;
}

}  // namespace fjr
