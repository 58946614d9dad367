// The effect of the arm's parameter uncertainty on a plan: tubes for charts, and a section of the report.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/chart_page.h"
#include "planner/results/json_field.h"

namespace fjr {

// Half widths of the tubes over time, from `robustness` in plan.json.
struct Tubes {
  struct Tube {
    std::string name;  // of a limit, or "link"
    int joint;         // 1 or 2; 0: neither
    std::vector<double> half;
  };
  std::vector<double> times;  // [s]
  std::vector<Tube> all;

  // Returns null if there is none.
  const std::vector<double>* find(const std::string& name, int joint) const;
};

// Returns nothing if the plan contains no robustness analysis.
std::optional<Tubes> read_tubes(const JsonField& plan);

// Adds what is guaranteed for other arms and with which probability, what that does not cover, and the margins with
// their cost. Adds nothing if the plan contains no robustness analysis.
void add_robustness(ChartPage& page, const JsonField& plan);

}  // namespace fjr
