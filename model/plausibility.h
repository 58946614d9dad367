// Checks whether a robot is physically possible, by inequalities that hold for every arm of two rigid bodies, springs
// and motors.
#pragma once

#include <string>
#include <vector>

#include "model/parameters.h"

namespace fjr {

enum class Verdict { kFine, kDoubtful, kImpossible };

// The result of one check of a value.
struct Finding {
  std::string check;     // "parallel axes"
  std::string field;     // "link.inertia"
  int joint = 1;         // 1 or 2
  std::string sentence;  // the value, and what it is compared with, with numbers
  Verdict verdict = Verdict::kFine;

  std::string text() const;  // "link.inertia.value[0]: 0.001 kg m^2 ..."
};

// Returns the results of all checks whether the robot is physically possible.
std::vector<Finding> findings_about(const Parameters& p);

// Returns only the findings that are not fine. Identified values contradict each other within their errors: the paper's
// own M1 is 11 % less than m1 (alpha1 l1)^2, which is the smallest possible inertia. So violations by more than about
// twice that count as impossible, and violations smaller than those of the paper's values are not reported.
std::vector<Finding> doubts_about(const Parameters& p);  // the findings that are not fine

}  // namespace fjr
