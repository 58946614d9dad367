// Post-optimal analysis of a solution by its multipliers: the shadow price of each limit, the sensitivity of the
// optimum to the request, and how well Pontryagin's conditions hold.
//
// All results refer to the problem that was optimised last. Its objective contains a regularisation by effort for
// minimum time (make_arm_ocp()), its friction law may still be smoothed, and its limits are tightened by margins.
// Values are in units of the request's objective.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "planner/problem/problem.h"

namespace fjr {

struct Collocated;

// The derivative of the optimal objective by one limit. It predicts the optimum to first order as long as the same
// limits stay active.
struct ShadowPrice {
  std::string name;     // as in the request's `limits`; for a task constraint: obstacles[0], tip_box, ...
  int joint = 0;        // 1 or 2, for a task constraint the link; 0 if it belongs to neither
  std::string unit;     // of the limit
  double limit = 0;     // for a task constraint: its size (TaskRow::scale)
  double price = 0;     // -d objective / d limit: what the objective gains with one unit more (of a constraint of the
                        // task: of clearance); 0 where never active
  double fraction = 0;  // of the duration in which it is active: within 1 % of the optimiser's (tightened) limit
  struct Stretch {
    double begin, end;  // [s]
  };
  std::vector<Stretch> active;
  std::size_t index = 0;  // in PerLimit (margins.h): of the limit, or of the first row of the task constraint
};

struct ViaPrices {
  double time = 0;                   // [s] where the motion passes it
  Joints<double> q{};                // d objective / d via position, per rad
  std::optional<Joints<double>> dq;  // per rad/s, where dq was given
  std::optional<double> later;       // d objective / d via time, per s, at constant duration; if a time was given
};

struct Sensitivity {
  std::vector<ShadowPrice> limits;  // of every finite limit and every task constraint
  std::optional<double> duration;   // d objective / d duration, per s, where it is fixed or at a bound
  std::vector<ViaPrices> via;
  Joints<double> goal{};  // d objective / d goal.q, per rad; a goal at rest moves with its equilibrium
};

// Pontryagin's conditions, with H = running cost + p'f and p the costate, d(cost to go)/dx.
struct Optimality {
  // H along the motion, as the mean over each interval. At an optimum it is constant between via points, and equals
  // minus the weight of time if the duration is free.
  struct Hamiltonian {
    double mean = 0;
    double spread = 0;               // root mean square deviation from the segment's mean, in time
    double largest = 0;              // deviation of one interval
    double time = 0;                 // [s] of the largest deviation
    std::optional<double> expected;  // mean at an optimum, if the duration is free
    double allowed = 0;              // spread up to which the solution counts as stationary

    bool stationary() const { return spread <= allowed; }
  } hamiltonian;
  // dH/du by the control u (the friction-compensated torque, or its rate if that is the control), for each control
  // variable of the discretisation, averaged over the collocation points that depend on it.
  struct Stationarity {
    double free = 0;      // root mean square in time where no limit is active; 0 at an optimum
    double wrong = 0;     // largest dH/du whose sign says to move away from an active limit; 0 at an optimum
    double largest = 0;   // largest |dH/du| anywhere, to compare the two with
    double residual = 0;  // largest |dH/du| including the multipliers of limits: the optimiser's dual residual
  } stationarity;
  double friction_width = 0;                     // [rad/s] of the friction law in the last solve; 0: the exact law
  State<double> costate_start{}, costate_end{};  // per rad, rad/s
  struct Along {                                 // the means over one interval
    double time;                                 // [s] its middle
    double hamiltonian;
    State<double> costate;
  };
  std::vector<Along> along;
};

struct Analysis {
  Sensitivity sensitivity;
  Optimality optimality;
};

// Analyses `solution`, a solution of `problem` as it was optimised, with its multipliers. scale: the request's
// objective was divided by this for the optimisation.
Analysis analyse(const Problem& problem, const Collocated& solution, double scale);

}  // namespace fjr
