// Brings an Nlp to the form an interior-point method needs: fixed variables become constants, inequalities get slacks,
// and large gradients are scaled down.
//
//   min f(v)  subject to  c(v) = 0,  lower <= v <= upper,   v = (free variables, slacks of the inequalities)
//
// c has a row for every constraint of the Nlp, in its order: g_i - g_lower_i for an equality, g_i - slack for an
// inequality.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "planner/nlp/chain/chain_ldlt.h"
#include "planner/nlp/nlp.h"

namespace fjr {

// A symmetric matrix given by the entries of one triangle; repeated entries add up.
struct SymmetricEntries {
  std::vector<int> rows, cols;
  std::vector<double> values;
};

// A point v with its multipliers: of the constraints, and of lower and upper bounds (zero where there is none). Or a
// step of all these.
struct PrimalDual {
  Eigen::VectorXd v, y, z_lower, z_upper;
};

class SlackForm {
 public:
  using Vector = Eigen::VectorXd;

  // Objective and constraints are scaled so that at x no gradient has an entry above 100, as Ipopt does by default. The
  // Nlp must outlive this object.
  SlackForm(const Nlp& nlp, const Vector& x);

  Eigen::Index variables() const { return lower.size(); }
  Eigen::Index constraints() const { return row_scale_.size(); }
  Vector lower, upper;                                     // of v; +-infinity where unbounded
  std::vector<Eigen::Index> lower_bounded, upper_bounded;  // where they are finite

  // Return the inverse distances of v from its bounds; zero where there is no bound.
  Vector inverse_distance_to_lower(const Vector& v) const { return (v - lower).cwiseInverse(); }
  Vector inverse_distance_to_upper(const Vector& v) const { return (upper - v).cwiseInverse(); }
  // Makes the multipliers of the bounds at least these, and zero where there is no bound.
  void keep_multipliers_above(const Vector& least_lower, const Vector& least_upper, PrimalDual& at) const;
  // Moves v to at least this relative distance inside its bounds, or the same fraction of the distance between two.
  void push_off_bounds(Vector& v, double push) const;
  // Return how much of a step, all of it at most, goes no more than a fraction of the way to the bounds, and lowers
  // bound multipliers by no more than that fraction: the fraction-to-the-boundary rule.
  double longest_step(const Vector& v, const Vector& dv, double fraction) const;
  double longest_multiplier_step(const PrimalDual& at, const PrimalDual& step, double fraction) const;

  Vector shift_weights;  // as in Nlp; if that has any, 0 for slacks, which are determined by their constraints

  // Conversions between v with its multipliers and the variables and multipliers of the Nlp.
  Vector from_x(const Vector& x) const;  // chooses slacks that satisfy their constraints
  Vector to_x(const Vector& v) const;
  Vector from_lambda(const Vector& lambda) const { return objective_scale_ * lambda.cwiseQuotient(row_scale_); }
  Vector to_lambda(const Vector& y) const { return y.cwiseProduct(row_scale_) / objective_scale_; }
  Vector from_bound_multipliers(const Vector& z) const;  // zero for slacks
  Vector to_bound_multipliers(const Vector& z) const;
  // Sets the bound multipliers of the slacks so that they are consistent with the constraint multipliers y.
  void set_slack_multipliers(const Vector& y, Vector& z_lower, Vector& z_upper) const;
  double objective_scale() const { return objective_scale_; }

  // Largest violation of the constraints of the Nlp, with and without scaling.
  struct Violation {
    double scaled = 0, own = 0;
  };
  Violation violation(const Vector& v, const Vector& c) const;

  double objective(const Vector& v) const;
  void constraint_values(const Vector& v, Vector& c) const;

  // The KKT matrix (H + D, J'; J, -e I). Each part has the value it was given by the last call below that sets it.
  const SymmetricEntries& kkt() const { return kkt_; }
  ChainStructure kkt_structure() const;
  void differentiate(const Vector& v, Vector& gradient);            // computes the gradient of f, and J
  void add_transposed_jacobian(const Vector& y, Vector& to) const;  // to += J' y
  void set_hessian(const Vector& v, const Vector& y);               // sets H to that of f + y'c
  void clear_hessian();
  void set_diagonal(const Vector& d, double e);
  void multiply(const Vector& by, Vector& product) const;  // the KKT matrix times a vector

 private:
  Vector scaled_part_of_free(const Vector& of_variables) const;
  bool inequality(Eigen::Index row) const { return slack_[static_cast<std::size_t>(row)] >= 0; }
  Eigen::Index slack_of(Eigen::Index row) const { return slack_[static_cast<std::size_t>(row)]; }
  const Vector& x_at(const Vector& v) const;
  void number_variables();
  void set_scales(const Vector& x);
  void set_bounds();
  void set_pattern();
  std::size_t jacobian_begin() const { return hessian_entry_.size(); }
  std::size_t diagonal_begin() const {
    return kkt_.rows.size() - static_cast<std::size_t>(variables() + constraints());
  }

  const Nlp& nlp_;
  double objective_scale_ = 1;
  Vector row_scale_;
  std::vector<Eigen::Index> free_;                            // index in x of each free variable
  std::vector<int> place_;                                    // index in v of each entry of x, -1 for fixed ones
  std::vector<Eigen::Index> slack_;                           // index in v of each constraint's slack, -1: equality
  SymmetricEntries kkt_;                                      // H, J, the slacks' -1 in J, the diagonal
  std::vector<Eigen::Index> hessian_entry_, jacobian_entry_;  // entries of the Nlp's patterns for free variables
  Vector hessian_values_, jacobian_values_, gradient_;        // values of the Nlp, before scaling
  mutable Vector x_;                                          // all variables of the Nlp, including fixed ones
};

}  // namespace fjr
