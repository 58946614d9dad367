// A solved motion of the arm in continuous time, given by its collocation polynomials.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "model/dynamics.h"

namespace fjr {

// Piecewise polynomial in time. On each interval, in c = (t - start) / duration:
// state (8) = sum_k state.col(k) c^k,  friction-compensated torque u (2) = sum_k torque.col(k) c^k  [N m].
// States are continuous; u may jump at the nodes.
struct Motion {
  struct Interval {
    double start, duration;
    Eigen::Matrix<double, kStates, Eigen::Dynamic> state;
    Eigen::Matrix<double, kControls, Eigen::Dynamic> torque;
  };
  std::vector<Interval> intervals;

  double duration() const { return intervals.back().start + intervals.back().duration; }

  // Returns the interval that contains `time`; at a node the one that begins there.
  std::size_t interval_at(double time) const {
    const auto after = std::upper_bound(intervals.begin(), intervals.end(), time,
                                        [](double t, const Interval& i) { return t < i.start; });
    return after == intervals.begin() ? 0 : static_cast<std::size_t>(after - intervals.begin()) - 1;
  }

  State<double> state_in(std::size_t interval, double time) const {
    const Eigen::Matrix<double, kStates, 1> x = polynomial(intervals[interval].state, interval, time);
    return State<double>::from(x.data());
  }
  // Returns the friction-compensated torque u [N m].
  Joints<double> torque_in(std::size_t interval, double time) const {
    const Eigen::Vector2d u = polynomial(intervals[interval].torque, interval, time);
    return {u(0), u(1)};
  }
  State<double> state_at(double time) const { return state_in(interval_at(time), time); }
  Joints<double> torque_at(double time) const { return torque_in(interval_at(time), time); }

 private:
  template <int kRows>
  Eigen::Matrix<double, kRows, 1> polynomial(const Eigen::Matrix<double, kRows, Eigen::Dynamic>& coefficients,
                                             std::size_t interval, double time) const {
    const double c = (time - intervals[interval].start) / intervals[interval].duration;
    Eigen::Matrix<double, kRows, 1> value = coefficients.col(coefficients.cols() - 1);
    for (Eigen::Index k = coefficients.cols() - 2; k >= 0; --k) value = value * c + coefficients.col(k);
    return value;
  }
};

}  // namespace fjr
