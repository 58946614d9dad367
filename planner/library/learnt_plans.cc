#include "planner/library/learnt_plans.h"

#include <exception>
#include <utility>

#include "common/say.h"
#include "planner/ocp/collocate.h"
#include "planner/problem/objective_terms.h"
#include "planner/problem/task/task.h"

namespace fjr {
namespace {

constexpr double kSame = 1e-3;  // [rad] a request this near an earlier one takes its place

bool has_one_minimum(const Problem& p) {
  return only_time(p.weights) && p.via.empty() && count_of_rows(p.task) == 0 && p.start_at_rest && p.goal.at_rest;
}

}  // namespace

LearntPlans::LearntPlans(std::size_t most, std::filesystem::path library) : most_(most), folder_(std::move(library)) {}

template <class Use>
void LearntPlans::with_library(const Use& use) {
  if (folder_.empty()) return;
  try {
    if (!library_) library_.emplace(folder_, PlanLibrary::Access::kWrite);
    use(*library_);
  } catch (const std::exception& error) {
    library_.reset();  // opened again the next time, as the cause may be gone by then
    if (told_ != error.what()) say("fjr: plan library not used: {}\n", error.what());
    told_ = error.what();
  }
}

std::optional<WarmStart> LearntPlans::nearest(const Problem& problem) {
  std::optional<WarmStart> found;
  double least = kNearby;
  if (const auto family = has_one_minimum(problem) ? family_of(problem) : std::nullopt) {
    for (const Earlier& earlier : plans_) {
      const double away = distance(earlier.problem, problem);
      if (earlier.family != *family || away > least) continue;
      least = away;
      found = WarmStart{earlier.solution, earlier.problem.name, away};
    }
  }
  with_library([&](const PlanLibrary& library) {
    const auto neighbour = library.nearest(problem, least);
    if (neighbour && (!found || neighbour->away < found->away)) found = warm_start_from(*neighbour);
  });
  return found;
}

void LearntPlans::remember(const Problem& problem, const std::string& request, const Plan& plan) {
  if (!plan.solution) return;
  if (const auto family = most_ > 0 && has_one_minimum(problem) ? family_of(problem) : std::nullopt) {
    std::erase_if(plans_, [&](const auto& earlier) {  // a request that is repeated drives no others out
      return earlier.family == *family && distance(earlier.problem, problem) <= kSame;
    });
    plans_.push_back({problem, *family, plan.solution});
    if (plans_.size() > most_) plans_.pop_front();
  }
  with_library([&](PlanLibrary& library) {
    if (library.any_within(problem, 0.5 * kNearby)) return;
    library.add(problem, request, plan.objective, *plan.solution);
  });
}

}  // namespace fjr
