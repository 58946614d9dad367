#include "planner/search/continuation_strategy.h"

#include "planner/problem/objective_terms.h"

namespace fjr {

// Each step is {width of the friction law [rad/s], regularisation by effort (make_arm_ocp())}; the solution of one step
// starts the next. There are three kinds of objectives:
// - It depends on friction (effort, energy, copper). At the optimum motors rest inside the step of the law, and with
//   widths that fall by a factor of about three every warm start converges within tens of iterations.
// - It does not. The law then only shifts the torque limits, and factors of ten and more converge. The regularisation
//   makes the first problems easy: 0.1 costs up to 2 % of the time. 0.01 remains in the end, which costs 0.03 to 0.1 %
//   of the time and saves half of the iterations.
// - It contains the largest torque, which does not depend on any smaller torque. The regularisation determines those:
//   with so much of it while the law is smooth that the first problem is easy, then with less and less, but not less
//   than 0.1, because later steps fail with 0.03. Where another term determines them there is no regularisation. The
//   last law is not the exact one, with which every second motion was lost when its mesh was refined
//   (bench/README.md), but sharp enough for a motor to rest or to move. Rows have the peak of the exact law.
ContinuationStrategy usual_strategy(const Problem& problem) {
  ContinuationStrategy usual;
  if (has_peak(problem.weights)) {
    if (!settles_torque(problem.weights)) usual.steps = {{0.1, 3}, {0.1, 1}, {0.1, 0.3}};
    for (const double width : {0.1, 0.03, 0.01, 0.003, 0.001}) usual.steps.push_back({width, 0.1});
  } else if (sees_friction(problem.weights)) {
    usual.steps = {{0.1}, {0.03}, {0.01}, {0.003}, {0.001}, {0.0003}, {0}};
  } else {
    usual.steps = {{0.1, 0.1}, {0.01, 0.1}, {0, 0.01}};
  }
  return usual;
}

// Many motions have nearly the same duration, so the regularisation by effort is fifty times the usual one and is kept.
// The first solution already has a friction width of 0.001 rad/s, and the steps to the exact law are shorter than
// usual, because the first two of longer ones failed. A margin of half a per cent of the torque leads to another motion
// and takes 66 to 183 iterations a round, so intervals are split instead. Gravity amplifies the errors of intervals, so
// these are split at once as finely as the certificate would ask for. With both, a swing-up with 5.5 N m takes 5 s of
// work from the exact law to the certificate, in five rounds.
ContinuationStrategy swinging_strategy() {
  ContinuationStrategy swinging;
  swinging.steps = {{0.1, 0.5}, {0.00056, 0.5}, {0.00032, 0.5}, {0, 0.5}};
  swinging.loose_steps = true;
  swinging.fades = false;
  swinging.begins_afresh = false;
  swinging.mesh = 1.0 / 3;
  swinging.worth_splitting = 1e-3;
  return swinging;
}

}  // namespace fjr
