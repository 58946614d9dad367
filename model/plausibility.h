// Whether there can be such a robot: inequalities that hold for every arm of two rigid bodies, springs and motors.
#pragma once

#include <string>
#include <vector>

#include "model/parameters.h"

namespace fjr {

// A value that is at odds with others or with nature.
struct Doubt {
  std::string field;     // "link.inertia"
  int joint = 1;         // 1 or 2
  std::string sentence;  // the value, and what it is held against, with numbers
  bool impossible = false;

  std::string text() const;  // "link.inertia.value[0]: 0.001 kg m^2 ..."
};

// Identified values miss each other by their errors: the paper's own M1 is 11 % less than m1 (alpha1 l1)^2, which is
// the least that a body can have. So what is wrong by more than about twice that is called impossible, and what is
// wrong by less than the paper's values are passes without a word.
std::vector<Doubt> doubts_about(const Parameters& p);

}  // namespace fjr
