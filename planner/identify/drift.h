// Whether an arm is still the one that its robot.yaml says: a sequential test on what was executed.
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

// Mean number of motions between two false alarms, at least.
inline constexpr double kMotionsPerFalseAlarm = 1000;

// Parameters that may have changed, and those besides that are uncertain: z is each in hundredths of its value, or in
// 10 g of payload.
struct DriftParameters {
  Prior of;                // names, and how large a z of 1 is
  std::size_t candidates;  // the first so many may have changed
};
DriftParameters drift_parameters(const Parameters& robot);

// What explains best that an arm is not the one known.
struct DriftCause {
  std::string parameter, unit;
  double known = 0, change = 0, error = 0;  // what it was, by how much it is off now, and the standard error of that
  double share = 0;                         // of all evidence, from 0 to 1
  std::size_t since = 0;                    // the motion that was the first with it, counted from 0
};

// Shiryaev and Roberts' procedure with mixtures for what is not known (Pollak & Siegmund, Biometrika 72, 1985): after
// every motion the evidence is the sum, over all motions that may have been the first with a change, of the likelihood
// ratio of a change then against none. The change is one of one parameter, normal with a standard deviation of 0.1, 1
// or 10 hundredths, each of them as likely. Without a change the evidence less the number of motions is a martingale,
// so that the mean number of motions before it exceeds a bound is at least that bound, whatever the motions are.
// Without a change the arm is robot.yaml's, off by what its covariance leaves open, and the same throughout.
class DriftTest {
 public:
  explicit DriftTest(const Parameters& robot);

  // A motion as one looks at it: what it tells about the arm that is off by `about`.
  struct Look {
    MotionInformation told;
    Eigen::VectorXd about;  // z
  };
  // Of the next motion, held against the arm that is expected, and again against what it then is expected to be where
  // robot.yaml leaves so much open that slopes change. Nothing where it tells nothing, or once it is stopped.
  std::optional<Look> look_at(const ExecutedMotion& motion, const ForEach& for_each = one_after_another,
                              const std::function<bool()>& stopped = not_stopped) const;

  void add(const Look& look);

  const Prior& parameters() const { return parameters_.of; }
  std::size_t motions() const { return motions_; }
  // Alarm: it is above kMotionsPerFalseAlarm.
  double evidence() const;
  bool drifts() const { return evidence() > kMotionsPerFalseAlarm; }
  // Of the evidence there is; nothing before the first motion.
  std::optional<DriftCause> cause() const;

 private:
  struct Change {            // that may have been
    std::size_t first;       // motion with it
    Eigen::MatrixXd matrix;  // of the motions since then
    Eigen::VectorXd score;
  };
  struct Likelihood {
    double log_ratio, change, deviation;  // of a change in z
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
  Eigen::MatrixXd known_;       // z = known_ xi, xi normal and independent: what robot.yaml leaves open
  Eigen::MatrixXd all_matrix_;  // of all motions, about z = 0
  Eigen::VectorXd all_score_;
  Expected expected_;
  std::deque<Change> changes_;
  std::size_t motions_ = 0;
};

}  // namespace fjr
