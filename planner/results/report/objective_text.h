// Describes the objective of a plan in words and units.
#pragma once

#include <string>
#include <vector>

#include "planner/problem/objective_terms.h"
#include "planner/results/json_field.h"

namespace fjr {

struct WeightedTerm {
  const TermInfo* info;
  double weight;  // negative: a reward
};

// Returns the terms with a weight in the resolved request in plan.json. Unknown terms of other versions are left out.
std::vector<WeightedTerm> weighted_terms(const JsonField& plan);

// Returns a formula such as "time" or "0.5 x effort + time"; "none" if there are no terms.
std::string objective_formula(const std::vector<WeightedTerm>& terms);

// Returns the unit of the objective: that of its only term if the weight is 1, otherwise "".
std::string objective_unit(const std::vector<WeightedTerm>& terms);

// How gains of the objective are expressed: as a time if time is the only term.
struct Gain {
  double factor;
  std::string unit;

  static Gain of(const std::vector<WeightedTerm>& objective);
  std::string saved(double objective) const;
};

}  // namespace fjr
