// The largest magnitude, or the largest value, of something over time, bounded from above at all times.
#pragma once

#include "common/enclosure/flow.h"

namespace fjr {

class Reach {
 public:
  // Of magnitudes. allowed: what they are to stay within.
  explicit Reach(double allowed) : allowed_(allowed), size_(allowed) {}
  // Of values with their signs. size: what the resolution is a fraction of, > 0.
  static Reach of_values(double allowed, double size);

  // Includes the polynomial c over [0, length], which begins at `time` [s]. False when it may leave what is allowed;
  // then bound() and time() say how far and where.
  bool include(const enclosure::Polynomial& c, const enclosure::Ball& length, double time);

  // Whether c changes nothing of bound(), as far as that shows at once.
  bool is_below(const enclosure::Polynomial& c, double length) const;

  double bound() const { return bound_; }  // none so far was larger
  double time() const { return time_; }    // [s] where it may be that large
  double allowed() const { return allowed_; }

 private:
  bool refine(const enclosure::Polynomial& c, double length, double time, int depth);
  bool take(double upper, double time);
  double most(const enclosure::Ball& b) const { return is_signed_ ? b.upper() : b.magnitude(); }
  double least(const enclosure::Ball& b) const { return is_signed_ ? b.lower() : b.mignitude(); }

  double allowed_, size_, bound_ = 0, time_ = 0;
  double found_ = 0;  // some were at least that large
  bool is_signed_ = false;
};

}  // namespace fjr
