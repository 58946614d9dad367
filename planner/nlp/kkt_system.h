// The linear systems of an interior-point method: the KKT matrix of a SlackForm, made to have the eigenvalues that a
// minimum has (Wächter & Biegler, section 3.1), factorised along the chain, and solved with.
#pragma once

#include "planner/nlp/slack_form.h"

namespace fjr {

class KktSystem {
 public:
  using Vector = Eigen::VectorXd;

  // both: how the halves of a factorisation and of a solution are worked off.
  KktSystem(const SlackForm& form, DoBoth both);

  // Of the form's derivatives, with the diagonal d added to the Hessian, and as much more as it takes. False when
  // nothing does.
  bool factorise(SlackForm& form, const Vector& d, double mu);
  // Without a Hessian: (I, J'; J, 0). False when J has not full rank.
  bool factorise_projection(SlackForm& form);

  Vector solve(const SlackForm& form, const Vector& right) const;  // refined until the residual is small

  int factorisations() const { return factorisations_; }
  double multiplications() const { return multiplications_; }

 private:
  enum class Inertia { kRight, kWrong, kSingular };
  Inertia try_with(SlackForm& form, const Vector& d, double shift, double regularised);

  ChainLdlt factor_;
  DoBoth both_;
  double shift_ = 0;       // of the last factorisation
  double last_shift_ = 0;  // that was needed, if any was
  int factorisations_ = 0;
  mutable double multiplications_ = 0;
};

}  // namespace fjr
