#include "planner/search/continuation_strategy.h"

#include "planner/problem/objective_terms.h"

namespace fjr {

// From smooth to exact, each solution starting the next. Effort lives in the friction's step, where a motor parks:
// steps of about three keep every warm start within tens of iterations. Without effort the law only moves a torque
// limit, and large steps do; there the regularisation by effort is what makes the first problems easy: with 0.1 of it
// the time is up to 2 % longer; with 0.01, which remains, by 0.03 to 0.1 %, and half the iterations are enough.
ContinuationStrategy usual_strategy(const Problem& problem) {
  ContinuationStrategy usual;
  if (sees_friction(problem.weights)) {
    usual.steps = {{0.1}, {0.03}, {0.01}, {0.003}, {0.001}, {0.0003}, {0}};
  } else {
    usual.steps = {{0.1, 0.1}, {0.01, 0.1}, {0, 0.01}};
  }
  return usual;
}

// The duration is nearly the same for many motions, so that the regularisation by effort is fifty times the usual one
// and is kept. The friction of the first solution has a width of 0.001 rad/s already, and the steps to the exact law
// are shorter than usual: of longer ones the first two could not be taken. A margin of half a per cent of the torque
// leads to another motion and takes 66 to 183 iterations a round, so that intervals are split instead. Gravity
// amplifies the errors of intervals, which are therefore split at once as finely as the certificate would ask for. With
// both a lift with 5.5 N m takes 5 s of work from the exact law to the certificate, in five rounds.
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
