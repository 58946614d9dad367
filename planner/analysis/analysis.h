// What a solution says about itself, by its multipliers: the shadow price of each limit, how the optimum moves with
// what was given, and how well the conditions of optimality hold.
//
// All of it is about the problem that was optimised last: its objective has a regularisation by effort in minimum time
// (make_arm_ocp()), its friction law may still be smoothed, and its limits are those less margins. Values
// are in units of the request's objective.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "planner/problem/problem.h"

namespace fjr {

struct Collocated;

// Derivatives of the optimal objective. An optimum changes by these to first order, as long as the same limits stay
// active.
struct ShadowPrice {
  std::string name;     // as in the request's `limits`; of a constraint of the task: obstacles[0], tip_box, ...
  int joint = 0;        // 1 or 2, of a constraint of the task the link; 0 where there is none
  std::string unit;     // of the limit
  double limit = 0;     // of a constraint of the task: its size (TaskRow::scale)
  double price = 0;     // -d objective / d limit: what the objective gains with one unit more (of a constraint of the
                        // task: of clearance); 0 where never active
  double fraction = 0;  // of the duration in which it is active: within 1 % of the limit as the optimiser had it
  struct Stretch {
    double begin, end;  // [s]
  };
  std::vector<Stretch> active;
  std::size_t index = 0;  // of the limit; of a constraint of the task, beyond them, its first row's
};

struct ViaPrices {
  double time = 0;                   // [s] where the motion passes it
  Joints<double> q{};                // d objective / d via position, per rad
  std::optional<Joints<double>> dq;  // per rad/s, where dq was given
  std::optional<double> later;  // d objective / d via time where that is given, per s, the duration staying as it is
};

struct Sensitivity {
  std::vector<ShadowPrice> limits;  // every finite one, and every constraint of the task
  std::optional<double> duration;   // d objective / d duration, per s, where it is fixed or at a bound
  std::vector<ViaPrices> via;
  Joints<double> goal{};  // d objective / d goal.q, per rad; a goal at rest moves with its equilibrium
};

// Pontryagin's conditions, with H = running cost + p'f and p the costate, d(cost to go)/dx.
struct Optimality {
  // H along the motion, as the mean over each interval: constant between via points, and minus the weight of time where
  // the duration is free.
  struct Hamiltonian {
    double mean = 0;
    double spread = 0;               // root mean square deviation from the leg's mean, in time
    double largest = 0;              // deviation of one interval
    double time = 0;                 // [s] where that is
    std::optional<double> expected;  // where the duration is free
    double allowed = 0;              // spread up to which the solution counts as stationary

    bool stationary() const { return spread <= allowed; }
  } hamiltonian;
  // dH/du, u the control (friction-compensated torque, or its rate where that is the control), at the controls of the
  // discretisation: averaged over the stages that see them.
  struct Stationarity {
    double free = 0;      // root mean square in time where no limit holds the control: 0 at an optimum
    double wrong = 0;     // largest dH/du that says to move away from an active limit: 0 at an optimum
    double largest = 0;   // |dH/du| anywhere: what the two compare to
    double residual = 0;  // largest of dH/du with the limits' multipliers, what the optimiser left
  } stationarity;
  double friction_width = 0;  // [rad/s] of the smoothed law that was optimised with; 0: the exact law
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

// problem: as it was optimised, `solution` its solution; `scale`: what the request's objective was divided by for that.
Analysis analyse(const Problem& problem, const Collocated& solution, double scale);

}  // namespace fjr
