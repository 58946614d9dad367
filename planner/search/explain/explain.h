// Why a request cannot be had, in physical terms: what is in the way, when, and the least that would have to change.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/problem/problem.h"
#include "planner/problem/relaxable.h"
#include "planner/search/continuation.h"
#include "planner/search/guesses.h"

namespace fjr {

// One thing of the request that, changed alone, makes it feasible.
struct Relaxation {
  RelaxableKind kind;
  std::string name;  // as in problem/relaxable.h; or duration; or via[0].time
  int joint = 0;     // 1 or 2; 0: neither
  std::string unit;
  double from = 0, to = 0;  // as asked for; the least change that was found to do, to within 4 %
  bool rough = false;  // not verified by planning, or found with friction smoothed only: `to` is about what it takes
  bool within_robot = true;                    // false: beyond what robot.yaml allows a request to ask for
  std::optional<double> time;                  // [s] when it is in the way most
  const ConstraintInfo* constraint = nullptr;  // of the task, where it is one
};

struct Infeasibility {
  std::string sentence;
  std::string limit;  // what is in the way, named as in Relaxation; empty where nothing single is
  int joint = 0;
  std::optional<double> time;               // [s] when
  std::vector<Relaxation> relaxations;      // the smallest change, relative to what was asked for, first
  std::optional<double> shortest_duration;  // [s] within the limits, where there is one
};

// `to` in four digits, rounded so that the change from `from` is never less than it was.
std::string enough(double from, double to);

// Why a request has no plan: it cannot have one; or it can, and from this motion it should be found; or it is not
// known.
struct WhyNot {
  std::optional<Infeasibility> infeasibility;
  std::optional<Guess> start;
};

// problem: what no motion was found for. `fastest`: the solution of fastest_of(problem), null if there is none.
// certified: whether its rows are exact enough to be published; otherwise its duration is told as about what it takes.
// reached: limits with which a motion was found on the way, on a coarse mesh; none where that was not tried.
WhyNot explain(const Problem& problem, const Continuation* fastest, bool certified,
               const std::optional<Limits>& reached, Session& session);

}  // namespace fjr
