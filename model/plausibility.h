// Whether there can be such a robot: inequalities that hold for every arm of two rigid bodies, springs and motors.
#pragma once

#include <string>
#include <vector>

#include "model/parameters.h"

namespace fjr {

enum class Verdict { kFine, kDoubtful, kImpossible };

// What a value was held against, and how it came out.
struct Finding {
  std::string check;     // "parallel axes"
  std::string field;     // "link.inertia"
  int joint = 1;         // 1 or 2
  std::string sentence;  // the value, and what it is held against, with numbers
  Verdict verdict = Verdict::kFine;

  std::string text() const;  // "link.inertia.value[0]: 0.001 kg m^2 ..."
};

// Whether there can be such a robot.
std::vector<Finding> findings_about(const Parameters& p);

// Identified values miss each other by their errors: the paper's own M1 is 11 % less than m1 (alpha1 l1)^2, which is
// the least that a body can have. So what is wrong by more than about twice that is called impossible, and what is
// wrong by less than the paper's values are passes without a word.
std::vector<Finding> doubts_about(const Parameters& p);  // the findings that are not fine

}  // namespace fjr
