// What a plan minimised, in words and units.
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

// Those that count, by plan.json's resolved request. Terms of another version are left out.
std::vector<WeightedTerm> weighted_terms(const JsonField& plan);

// "time", "0.5 x effort + time"; "none" where nothing counts.
std::string objective_formula(const std::vector<WeightedTerm>& terms);

// Of the sum: that of the only term where its weight is 1; otherwise none, "".
std::string objective_unit(const std::vector<WeightedTerm>& terms);

// How gains of the objective are told: as time where nothing else counts.
struct Gain {
  double factor;
  std::string unit;

  static Gain of(const std::vector<WeightedTerm>& objective);
  std::string saved(double objective) const;
};

}  // namespace fjr
