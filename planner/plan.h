// Plans one request: searches for a motion, certifies it, and concludes.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "planner/analysis/analysis.h"
#include "planner/certificate/certificate.h"
#include "planner/nlp/solve_cost.h"
#include "planner/problem/problem.h"
#include "planner/search/account.h"
#include "planner/search/explain/relaxation.h"
#include "planner/search/settings.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

enum class PlanStatus {
  kCertified,     // the trajectory may be used
  kBadInput,      // refused before any optimisation
  kInfeasible,    // the limits exclude every motion found; `reason` says which
  kNotConverged,  // the optimiser stopped without a solution
  kUncertified,   // a trajectory exists but its certificate failed
  kDeadline,      // stopped by the time budget
  kCancelled,     // stopped by the caller
};

const char* name(PlanStatus status);                           // the name in plan.json: "certified", "bad_input", ...
std::optional<PlanStatus> plan_status(std::string_view name);  // the status of that name; none: no such name
int exit_code(PlanStatus status);                              // as in the README

struct Collocated;  // planner/ocp/collocate.h: a solution, with what a neighbouring problem needs to start from

// Solution of a neighbouring request (Plan::solution).
struct WarmStart {
  std::shared_ptr<const Collocated> solution;
  std::string name;                 // name of the plan it comes from
  std::optional<double> away = {};  // [rad] largest difference of an angle of start or goal, if known
};

struct PlanOptions {
  double deadline = 0;  // [s] of wall time; 0: none
  std::string linear_solver = "stage";
  int starts = 0;  // 0: as the request's `search` and its objective say
  int jobs = 1;    // threads; 0: as many as there are cores. The plan does not depend on it.
  // [s] limit on the optimiser's work (SolveReport::work); a longer deadline raises it. It is not a time, so that the
  // same request gives the same plan on a busy machine too. More starts may take more in proportion, and so may
  // requests for which no start leads to a motion, and slow motions that have come to nothing else (BudgetSettings).
  double most_work = 60;
  // If given, it is tried first; if it leads to a certified plan, nothing else is tried.
  std::optional<WarmStart> warm;
  bool proven = false;  // demands a proof as Problem::proven does
  // For experts: constants that tune the search. What they may be is checked where a file is read (load_settings()),
  // not here.
  SearchSettings search{};
  std::function<void(const Progress&)> on_progress;
  std::function<bool()> cancelled;  // polled between iterations
};

struct Plan {
  PlanStatus status = PlanStatus::kNotConverged;
  std::string reason;                          // one sentence when not certified
  std::optional<Infeasibility> infeasibility;  // details of the reason, if they are known
  double duration = 0;                         // [s]
  std::vector<double> via_times;               // [s] when the via points, or the corners of a path, are passed
  double objective = 0;                        // of the published rows
  std::map<std::string, double> terms;  // terms of the objective without their weights, also those with weight zero
  int intervals = 0;
  std::string method;
  double error_estimate = 0;            // [rad] largest local error of an interval
  std::vector<double> node_times;       // [s] of the mesh, intervals + 1
  std::vector<double> interval_errors;  // [rad] local error of each interval
  int iterations = 0;                   // over all stages and starts
  SolveCost cost;                       // likewise
  std::vector<SolverStage> stages;
  bool warm = false;                        // it was found from PlanOptions::warm, without other starts
  std::optional<std::string> warm_refusal;  // clause that says why PlanOptions::warm gave no plan, if it was given
  std::string warm_name;                    // WarmStart::name, also if it gave no plan
  std::optional<double> warm_away;          // WarmStart::away
  int starts = 0;                           // number of starts that were solved
  int starts_planned = 0;                   // number of starts that the search would have solved in any case
  int refined = 0;                          // number of minima that were followed to the exact problem
  bool cut_by_deadline = false;  // certified, but the deadline ended the search: more time may find a better motion
  std::vector<double> minima;  // objectives of the distinct minima of all starts, best first, on their first meshes and
                               // with smoothed friction
  // What penalties on accelerations (planner/search/acceleration_penalty.h) added to the optimised objective, in its
  // own unit. `objective` does not contain it, shadow prices and optimality do.
  double acceleration_penalty = 0;
  bool cut_by_work = false;  // the search ended at the limit on its work; a longer deadline raises it
  Fallbacks fallbacks;
  SearchSettings settings{};  // PlanOptions::search
  double back_off = 0;        // largest fraction of any limit that is kept free on any interval
  std::optional<Trajectory> trajectory;
  std::optional<Certificate> certificate;
  std::shared_ptr<const Collocated> solution;  // of the certified trajectory
  std::optional<Analysis> analysis;            // of that solution
  std::map<std::string, double> timing;        // [s] by part, and "total"; CPU time: of `cost`, and "cpu" of all

  // Returns the times [s] at which the motion's segments end.
  std::vector<double> segment_ends() const {
    std::vector<double> ends = via_times;
    ends.push_back(duration);
    return ends;
  }
};

// Plans a motion and certifies it. A problem without solution is not an error; `status` and `reason` describe the
// outcome. The plan is a function of the problem and the options, the same to the last bit for any number of jobs,
// unless a deadline or `cancelled` ends the search. problem: as resolve() (planner/request/request.h) makes it; one
// that is filled in otherwise needs robot, limits, start, goal, duration and weights, and a request_hash for plan.json.
// Throws std::runtime_error if the linear solver cannot be loaded. Several threads may plan at a time with the linear
// solver "stage", and one with any other.
Plan plan(const Problem& problem, const PlanOptions& options);

}  // namespace fjr
