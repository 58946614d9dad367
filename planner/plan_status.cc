// Names and exit codes of outcomes: what plan.json, the command line and the service agree on.
#include <stdexcept>

#include "planner/plan.h"

namespace fjr {

const char* name(PlanStatus status) {
  switch (status) {
    case PlanStatus::kCertified:
      return "certified";
    case PlanStatus::kBadInput:
      return "bad_input";
    case PlanStatus::kInfeasible:
      return "infeasible";
    case PlanStatus::kNotConverged:
      return "not_converged";
    case PlanStatus::kUncertified:
      return "uncertified";
    case PlanStatus::kDeadline:
      return "deadline";
    case PlanStatus::kCancelled:
      return "cancelled";
  }
  throw std::logic_error("PlanStatus out of range");
}

int exit_code(PlanStatus status) {
  switch (status) {
    case PlanStatus::kCertified:
      return 0;
    case PlanStatus::kBadInput:
      return 2;
    case PlanStatus::kInfeasible:
    case PlanStatus::kNotConverged:
      return 3;
    case PlanStatus::kUncertified:
      return 4;
    case PlanStatus::kDeadline:
    case PlanStatus::kCancelled:
      return 5;
  }
  throw std::logic_error("PlanStatus out of range");
}

}  // namespace fjr
