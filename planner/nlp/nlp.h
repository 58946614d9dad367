// The interface between nonlinear programs and the methods that solve them (solve.h).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/parallel.h"

namespace fjr {

// min f(x)  subject to  g_lower <= g(x) <= g_upper,  x_lower <= x <= x_upper.
// Sizes, bounds and patterns are fixed at construction; evaluation is const and gives the same bits for the same x.
class Nlp {
 public:
  using In = Eigen::Ref<const Eigen::VectorXd>;
  using Out = Eigen::Ref<Eigen::VectorXd>;
  struct Entry {
    int row, col;
  };

  virtual ~Nlp() = default;

  Eigen::VectorXd x_lower, x_upper;  // n; +-infinity where unbounded
  Eigen::VectorXd g_lower, g_upper;  // m
  // n; relative size per variable of the shift that the inertia correction adds to the diagonal of the Hessian. Empty
  // means 1 for all. Only our own method (interior_point.h) uses it; Ipopt has no such option.
  Eigen::VectorXd shift_weights;
  std::vector<Entry> jacobian_pattern;
  std::vector<Entry> hessian_pattern;  // lower triangle; repeated entries add up

  // Block of every variable and constraint if the problem is a chain: the constraints of a block depend on variables of
  // that block, of the one before it, and of the border, whose block number is `blocks`. blocks = 0 means that the
  // structure is unknown.
  int blocks = 0;
  std::vector<int> variable_block, constraint_block;

  // Runs the two halves of an evaluation, possibly on two threads; the results are the same bits.
  DoBoth both = one_after_the_other;

  Eigen::Index variables() const { return x_lower.size(); }
  Eigen::Index constraints() const { return g_lower.size(); }

  virtual double objective(const In& x) const = 0;
  virtual void gradient(const In& x, Out out) const = 0;           // n
  virtual void constraint_values(const In& x, Out out) const = 0;  // m
  virtual void jacobian(const In& x, Out out) const = 0;           // one per jacobian_pattern entry
  // Second derivatives of cost_factor f + multipliers' g; one per hessian_pattern entry.
  virtual void hessian(const In& x, double cost_factor, const In& multipliers, Out out) const = 0;
};

}  // namespace fjr
