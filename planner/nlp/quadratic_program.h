// The quadratic program at a point of a SlackForm: its constraints linearised there, and the quadratic model of its
// Lagrangian. It is what one step of sequential quadratic programming solves (Nocedal & Wright, Numerical Optimization,
// chapter 18). No function of the problem is evaluated, and the KKT matrix changes in its diagonal alone.
#pragma once

#include <functional>
#include <optional>

#include "planner/nlp/kkt_system.h"
#include "planner/nlp/slack_form.h"

namespace fjr {

// Solves, by an interior-point method with predictor and corrector (Mehrotra, SIAM Journal on Optimization 2, 1992),
//
//   min gradient'd + d'(H + rho I)d / 2   subject to  c + J d = 0,  lower <= at.v + d <= upper
//
// with a small weight rho on changes, which settles what the optimum hardly depends on. H and J are those that the form
// was last given, gradient and c those of its objective and constraints at the point. Returns the point at.v + d and
// its multipliers, whose products with the distances from the bounds are about mu. Returns nothing if three steps in a
// row are short, which is taken as a sign that the bounds leave no such d; if the KKT matrix cannot be factorised, if
// 30 iterations do not suffice because H is far from convex, or if may_go_on, asked before each of them, returns false.
//
// It begins away from all bounds, wherever the point is: a Newton step from a point at its bounds is blocked by the
// first one that ceases to be active, or becomes so, and a method that begins there needs some iterations for each.
std::optional<PrimalDual> solve_quadratic_program(SlackForm& form, KktSystem& system, const PrimalDual& at,
                                                  const Eigen::VectorXd& gradient, const Eigen::VectorXd& c, double mu,
                                                  const std::function<bool()>& may_go_on);

}  // namespace fjr
