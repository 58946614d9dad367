// Progress reports of a running search, and the account of what it did.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "planner/nlp/solve_cost.h"

namespace fjr {

// The phases of a search. Each may use what earlier ones left of the work, up to a larger fraction of it
// (BudgetSettings).
enum class Phase {
  kFinding,     // motions on coarse meshes
  kRefining,    // solutions that may become the best plan
  kMargins,     // adds margins for parameter errors to a certified motion
  kExplaining,  // why there is none
  kDamping,     // plans the best coarse motion with a penalty on accelerations, if no plan came of anything else
};

// State of the search, reported between iterations of the optimiser.
struct Progress {
  std::string stage;  // "start 2 of 4, friction width 0.01 rad/s", "start 2 of 4, 80 intervals"
  int iteration = 0;  // over the whole plan
  double objective = 0;
  double violation = 0;                // of the constraints, scaled
  Phase phase = Phase::kFinding;       // the latest so far
  int starts = 0, starts_planned = 0;  // finished starts, and starts that will be tried
  double work = 0, most_work = 0;      // [s] of work done in all threads, and allowed; 0: without bound
  double deadline = 0;                 // [s] of wall time since the beginning; 0: none
};

struct SolverStage {
  std::string name;  // what was solved
  int intervals = 0;
  int iterations = 0;
  double objective = 0;
  std::string status;
  SolveCost cost{};
  double work = 0;  // SolveReport::work
};

// Counts how often each fallback was used; planner/search/fallbacks.h has the order in which they are tried.
struct Fallbacks {
  int adaptive_barrier = 0;  // a warm start failed; tried again with multipliers forgotten and an adaptive barrier
  int friction_level = 0;    // a step to a sharper friction law stopped at the iteration limit
  int calmed = 0;            // a motion was tried again with a penalty on acceleration
  int displaced_start = 0;   // starts beyond those that are always tried
  int swinging = 0;          // limits relaxed until the arm can be carried, then tightened step by step
  int patience = 0;          // a start with many more iterations, and at first ten times the regularisation
  int coarser_mesh = 0, finer_mesh = 0;
  int relaxed_limits = 0;  // limits relaxed, then tightened step by step
  int from_fastest = 0;    // from the fastest motion, stretched to the time there is

  Fallbacks& operator+=(const Fallbacks& other);
};

template <class F, class Visit>
constexpr void visit_fallbacks(F& f, Visit&& visit) {
  visit("adaptive_barrier", f.adaptive_barrier);
  visit("friction_level", f.friction_level);
  visit("calmed", f.calmed);
  visit("displaced_start", f.displaced_start);
  visit("swinging", f.swinging);
  visit("patience", f.patience);
  visit("coarser_mesh", f.coarser_mesh);
  visit("finer_mesh", f.finer_mesh);
  visit("elastic", f.relaxed_limits);
  visit("from_fastest", f.from_fastest);
}

struct Account {
  std::vector<SolverStage> stages;  // in the order in which they were solved
  int iterations = 0;               // of all of them
  SolveCost cost;                   // likewise
  double work = 0;                  // likewise [s], SolveReport::work
  Fallbacks fallbacks;
  bool cut_by_work = false;  // a phase ended because its work was used up
  // [s] of time by part; none is counted twice, but what several threads do at once counts for each.
  std::map<std::string, double> timing;
  double cpu_of_others = 0;  // [s] CPU time of other threads than the caller's

  Account& operator+=(const Account& other);
  void add_time_of(const Account& other);  // adds timing and CPU time alone, for work whose results are discarded
};

}  // namespace fjr
