// What a service's worker starts requests from: the plans that it has made since it began, and a plan library, if there
// is one, which what is learnt goes into and which outlives it.
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

// In memory only minimum-time plans: those have one minimum for practical purposes, while with effort in the objective
// the neighbour's may be far from the best here. A library has whatever it was built for as well.
//
// A library that fails, on a full disk for instance, is told of on stderr, once for each reason, and never keeps a plan
// from being made.
class LearntPlans {
 public:
  // most: plans in memory; library: its folder, empty for none.
  LearntPlans(std::size_t most, std::filesystem::path library);

  // What to start from; none: nothing that is near enough.
  std::optional<WarmStart> nearest(const Problem& problem);

  // request: YAML. Into the library goes what was planned farther than half of kNearby from what is in there.
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
  std::string told_;  // of why the library failed
};

}  // namespace fjr
