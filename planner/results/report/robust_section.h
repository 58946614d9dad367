// What the uncertainty of the arm's parameters makes of a plan: tubes for charts, and a section.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/chart_page.h"
#include "planner/results/json_field.h"

namespace fjr {

// Half widths over time, as plan.json's robustness has them.
struct Tubes {
  struct Tube {
    std::string name;  // of a limit, or "link"
    int joint;         // 1 or 2; 0: neither
    std::vector<double> half;
  };
  std::vector<double> times;  // [s]
  std::vector<Tube> all;

  // Null where there is none.
  const std::vector<double>* find(const std::string& name, int joint) const;
};

// None where the plan says nothing of other arms.
std::optional<Tubes> read_tubes(const JsonField& plan);

// What is promised of other arms, with which probability, and what that does not cover; margins, and what they cost.
// Nothing where the plan says nothing of it.
void add_robustness(ChartPage& page, const JsonField& plan);

}  // namespace fjr
