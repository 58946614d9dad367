// What a search tells while it runs, and the account of what it did.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "planner/nlp/solve_cost.h"

namespace fjr {

// What a request's work is spent on; a later phase may take more of it.
enum class Phase {
  kFinding,     // motions on coarse meshes
  kRefining,    // those that promise something
  kMargins,     // of what is certified, for other arms
  kExplaining,  // why there is none
};

// Asked and told between iterations of the optimiser.
struct Progress {
  std::string stage;  // "start 2 of 4, friction 0.01 rad/s, 80 intervals"
  int iteration = 0;  // over the whole plan
  double objective = 0;
  double violation = 0;                // of the constraints, scaled
  Phase phase = Phase::kFinding;       // the latest so far
  int starts = 0, starts_planned = 0;  // that have come to an end, and that the search means to try
  double work = 0, most_work = 0;      // [s] that was done, in all threads, and that may be done; 0: without bound
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
  int calmed = 0;           // a start ended at its limit of iterations; tried again with springs that are to swing less
  int displaced_start = 0;  // starts beyond those that are always tried
  int swinging = 0;         // limits that carry the arm, tightened step by step
  int patience = 0;         // a start with many more iterations, and more than a regularisation by effort at first
  int coarser_mesh = 0, finer_mesh = 0;
  int relaxed_limits = 0;  // limits relaxed, then tightened step by step
  int from_fastest = 0;    // from the fastest motion, stretched to the time there is

  Fallbacks& operator+=(const Fallbacks& other);
};

template <class F, class Visit>
void visit_fallbacks(F& f, Visit&& visit) {
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
  bool cut_by_work = false;  // a phase ended where it may take no more
  // [s] of time by part; none is counted twice, but what several threads do at once counts for each.
  std::map<std::string, double> timing;
  double cpu_of_others = 0;  // [s] CPU time of other threads than the caller's

  Account& operator+=(const Account& other);
  void add_time_of(const Account& other);  // timing and CPU time alone: of what was done in vain
};

}  // namespace fjr
