// The plans from which a service's worker warm-starts requests: those it has made since it started, and those of a plan
// library, if there is one. New plans are added to the library.
#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "planner/library/plan_library.h"
#include "planner/plan.h"

namespace fjr {

// In memory only minimum-time plans from rest to rest without via points and task are kept. These practically have a
// single minimum, while with effort in the objective the minimum of a neighbour may be far from the best one. A library
// may contain other plans as well.
//
// If the library fails, for instance on a full disk, that is reported on stderr once per reason, and planning goes on.
class LearntPlans {
 public:
  // most: plans in memory; library: its folder, empty for none.
  LearntPlans(std::size_t most, std::filesystem::path library);

  // Returns the plan to start from, or nothing if none is near enough.
  std::optional<WarmStart> nearest(const Problem& problem);

  // Adds a plan, in the place of those whose start and goal are the same to 1e-3 rad. It goes into the library if it is
  // farther than half of kNearby from the plans there. request: YAML.
  void remember(const Problem& problem, const std::string& request, const Plan& plan);

 private:
  struct Earlier {
    Problem problem;
    std::string family;
    std::shared_ptr<const Collocated> solution;
  };

  template <class Use>
  void with_library(const Use& use);

  std::size_t most_;
  std::deque<Earlier> plans_;
  std::filesystem::path folder_;
  std::optional<PlanLibrary> library_;
  std::string told_;  // the last reported reason why the library failed
};

}  // namespace fjr
