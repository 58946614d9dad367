#include "planner/search/continuation_strategy.h"

#include "planner/problem/objective_terms.h"

namespace fjr {

// The steps lead from a smooth to the exact friction law, each solution starting the next. Optima of objectives that
// depend on friction have motors resting within the step of the law; steps of about a factor of three keep every warm
// start within tens of iterations. For other objectives the law only shifts the torque limit, and large steps do. There
// the regularisation by effort makes the first problems easy: with 0.1 of it the time is up to 2 % longer; with 0.01,
// which remains, by 0.03 to 0.1 %, and half the iterations are enough.
//
// The largest torque leaves all smaller ones free. While the law is smooth they are settled by so much effort that the
// first problem is easy, and then by less and less of it; with 0.03 of it in the end later steps fail. The last law is
// sharp enough for a motor to rest or to move, and in rows the peak is that of the exact law. With exact friction every
// second motion was lost when its mesh was refined (bench/README.md). Where another term settles the torque, there is
// no regularisation.
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
