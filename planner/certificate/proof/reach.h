// The largest magnitude of something over time, bounded from above at all times.
#pragma once

#include "common/enclosure/flow.h"

namespace fjr {

class Reach {
 public:
  // allowed: what the magnitude is to stay within.
  explicit Reach(double allowed) : allowed_(allowed) {}

  // Includes the polynomial c over [0, length], which begins at `time` [s]. False when it may leave what is allowed;
  // then bound() and time() say how far and where.
  bool include(const enclosure::Polynomial& c, const enclosure::Ball& length, double time);

  double bound() const { return bound_; }  // no magnitude so far was larger
  double time() const { return time_; }    // [s] where it may be that large
  double allowed() const { return allowed_; }

 private:
  bool refine(const enclosure::Polynomial& c, double length, double time, int depth);
  bool take(double upper, double time);

  double allowed_, bound_ = 0, time_ = 0;
  double found_ = 0;  // some magnitude was at least that large
};

}  // namespace fjr
