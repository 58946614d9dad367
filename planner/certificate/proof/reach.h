// Rigorous upper bound on the largest magnitude, or the largest value, of a quantity over time.
#pragma once

#include "common/enclosure/flow.h"

namespace fjr {

class Reach {
 public:
  // Bounds magnitudes. allowed: what they have to stay within.
  explicit Reach(double allowed) : allowed_(allowed), size_(allowed) {}
  // Bounds values with their signs. size: scale of the resolution, > 0.
  static Reach of_values(double allowed, double size);

  // Includes the polynomial c over [0, length], which begins at `time` [s]. Returns false if it may leave what is
  // allowed; bound() and time() then say how far and when.
  bool include(const enclosure::Polynomial& c, const enclosure::Ball& length, double time);

  // Returns whether a quick estimate shows that c does not change bound().
  bool is_below(const enclosure::Polynomial& c, double length) const;

  double bound() const { return bound_; }  // no value so far was larger
  double time() const { return time_; }    // [s] where it may be that large
  double allowed() const { return allowed_; }

 private:
  bool refine(const enclosure::Polynomial& c, double length, double time, int depth);
  bool take(double upper, double time);
  double most(const enclosure::Ball& b) const { return is_signed_ ? b.upper() : b.magnitude(); }
  double least(const enclosure::Ball& b) const { return is_signed_ ? b.lower() : b.mignitude(); }

  double allowed_, size_, bound_ = 0, time_ = 0;
  double found_ = 0;  // lower bound of the largest value
  bool is_signed_ = false;
};

}  // namespace fjr
