// The linear systems of an interior-point method: the KKT matrix of a SlackForm, whose inertia is corrected if
// necessary (Wächter & Biegler, section 3.1) and which is factorised along the chain.
#pragma once

#include "planner/nlp/slack_form.h"

namespace fjr {

class KktSystem {
 public:
  using Vector = Eigen::VectorXd;

  // both: runs the two halves of a factorisation or a solve, possibly on two threads.
  KktSystem(const SlackForm& form, DoBoth both);

  // Factorises the KKT matrix of the form's derivatives, with the diagonal d added to the Hessian and as large a shift
  // as the right inertia requires. Returns false if no shift up to 1e20 suffices. mu: barrier parameter.
  bool factorise(SlackForm& form, const Vector& d, double mu);
  // Factorises (I, J'; J, 0), for least-squares multipliers. Returns false if J does not have full rank.
  bool factorise_projection(SlackForm& form);

  // Begins the next inertia correction without a shift, as the first one does.
  void forget_shift() { shift_ = last_shift_ = 0; }

  Vector solve(const SlackForm& form, const Vector& right) const;  // refined until the residual is small

  int factorisations() const { return factorisations_; }
  double multiplications() const { return multiplications_; }

 private:
  enum class Inertia {
    kRight,
    kWrong,
    kSingular  // or with too few negative eigenvalues, which only roundings make
  };
  Inertia try_with(SlackForm& form, const Vector& d, double shift, double regularised);

  ChainLdlt factor_;
  DoBoth both_;
  double shift_ = 0;       // shift of the Hessian in the last factorisation
  double last_shift_ = 0;  // last shift that was not zero
  int factorisations_ = 0;
  mutable double multiplications_ = 0;
};

}  // namespace fjr
