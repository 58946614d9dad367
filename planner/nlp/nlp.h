// The one seam between what is optimised and who optimises it.
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
  // n; of what is added to the Hessian's diagonal where that is not positive definite on the constraints; empty: all
  // the same. Our own method (interior_point.h) goes by it, Ipopt cannot.
  Eigen::VectorXd shift_weights;
  std::vector<Entry> jacobian_pattern;
  std::vector<Entry> hessian_pattern;  // lower triangle; repeated entries add up

  // Block of every variable and constraint when the problem is a chain: constraints of a block see variables of that
  // and of the block before, and those of the border, whose block is `blocks`. 0 blocks: nothing is known of the
  // structure.
  int blocks = 0;
  std::vector<int> variable_block, constraint_block;

  // How the halves of what an evaluation consists of are worked off; the bits are the same.
  DoBoth both = one_after_the_other;

  Eigen::Index variables() const { return x_lower.size(); }
  Eigen::Index constraints() const { return g_lower.size(); }

  virtual double objective(const In& x) const = 0;
  virtual void gradient(const In& x, Out out) const = 0;           // n
  virtual void constraint_values(const In& x, Out out) const = 0;  // m
  virtual void jacobian(const In& x, Out out) const = 0;           // one per jacobian_pattern entry
  // Of cost_factor f + multipliers' g: one per hessian_pattern entry.
  virtual void hessian(const In& x, double cost_factor, const In& multipliers, Out out) const = 0;
};

}  // namespace fjr
