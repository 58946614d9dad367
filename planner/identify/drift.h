// A sequential test on executed motions whether an arm has drifted from the parameters in its robot.yaml.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "planner/identify/information.h"

namespace fjr {

// Lower bound of the mean number of motions until a false alarm.
inline constexpr double kMotionsPerFalseAlarm = 1000;

// The parameters that may have changed, followed by the other uncertain ones. z expresses their errors in hundredths of
// their values, and for the payload in units of 10 g.
struct DriftParameters {
  Prior of;                // names, and the size of z = 1
  std::size_t candidates;  // number of parameters, from the first on, that may have changed
};
DriftParameters drift_parameters(const Parameters& robot);

// The change that best explains why an arm differs from the known one.
struct DriftCause {
  std::string parameter, unit;
  double known = 0, change = 0, error = 0;  // known value, estimated change, and the standard error of the change
  double share = 0;                         // fraction of all evidence for this parameter, from 0 to 1
  std::size_t since = 0;                    // the first motion with the change, counted from 0
};

// The Shiryaev-Roberts procedure with mixtures for the unknown change (Pollak & Siegmund, Biometrika 72, 1985). After
// every motion, the evidence is the sum of likelihood ratios over all motions that may be the first with a change: of a
// change at that motion against no change. The change affects one parameter and is normally distributed with a standard
// deviation of 0.1, 1 or 10 hundredths, all with the same weight. Without a change, the evidence minus the number of
// motions is a martingale. Therefore the mean number of motions until it exceeds a bound is at least that bound, for
// any motions. Without a change the arm has constant parameters that differ from robot.yaml according to its
// covariance.
class DriftTest {
 public:
  explicit DriftTest(const Parameters& robot);

  // The information of a motion about the parameters, linearised at the errors `about`.
  struct Look {
    MotionInformation told;
    Eigen::VectorXd about;  // z
  };
  // Evaluates the next motion, linearised at the expected arm. If the motion moves that expectation so far that slopes
  // change, it linearises again. Returns nothing if the motion has no information, or once stopped() is true.
  std::optional<Look> look_at(const ExecutedMotion& motion, const ForEach& for_each = one_after_another,
                              const std::function<bool()>& stopped = not_stopped) const;

  void add(const Look& look);

  const Prior& parameters() const { return parameters_.of; }
  std::size_t motions() const { return motions_; }
  // Returns the evidence for a change; above kMotionsPerFalseAlarm the test gives an alarm.
  double evidence() const;
  bool drifts() const { return evidence() > kMotionsPerFalseAlarm; }
  // Returns the likeliest cause given the present evidence; nothing before the first motion.
  std::optional<DriftCause> cause() const;

 private:
  struct Change {            // a hypothetical change
    std::size_t first;       // first motion with it
    Eigen::MatrixXd matrix;  // sums over the motions since then
    Eigen::VectorXd score;
  };
  struct Likelihood {
    double log_ratio, change, deviation;  // log likelihood ratio; estimate of the change in z, and its deviation
  };

  struct Expected {  // of z without a change
    Eigen::MatrixXd covariance;
    Eigen::VectorXd mean;
  };
  Expected expected(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& score) const;
  Likelihood likelihood(const Change& change, Eigen::Index candidate, double size) const;
  template <class Visit>
  void visit(Visit&& visit) const;

  Parameters robot_;
  DriftParameters parameters_;
  Eigen::MatrixXd known_;       // z = known_ xi, with independent normal xi, is the uncertainty in robot.yaml
  Eigen::MatrixXd all_matrix_;  // sums over all motions, expanded about z = 0
  Eigen::VectorXd all_score_;
  Expected expected_;
  std::deque<Change> changes_;
  std::size_t motions_ = 0;
};

}  // namespace fjr
