// Residuals between the readings of executed motions and a simulated arm with unknown parameters and initial states.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/not_stopped.h"
#include "common/parallel.h"
#include "planner/identify/prior.h"
#include "planner/identify/replay.h"

namespace fjr {

// Returns the arm with the named parameters changed by `by`. Unlike changed() it applies no bounds: the fit must be
// able to pass through a negative mass to find a very small one.
Parameters moved(const Parameters& known, const std::vector<std::string>& names, const Eigen::VectorXd& by);

// The residuals of all motions, divided into pieces. The unknowns are the prior's independent numbers z, followed by
// the deviation of each piece's initial state from its guess (in units so large that the readings alone determine it).
// The residuals are those of the readings of each piece, in standard deviations of a count, followed by the unknowns
// themselves. The constructor's arguments must outlive this object. stopped is called before every rollout; once it
// returns true, evaluations fail.
class Readings {
 public:
  Readings(const Parameters& known, const Prior& prior, const std::vector<ExecutedMotion>& motions,
           const ForEach& for_each, const std::function<bool()>& stopped = not_stopped);

  std::size_t pieces() const { return pieces_.size(); }
  std::size_t motion_of(std::size_t piece) const { return pieces_[piece].motion; }
  Eigen::Index parameters() const { return prior_.factor.cols(); }
  Eigen::Index unknowns() const { return parameters() + kStates * static_cast<Eigen::Index>(pieces_.size()); }
  Eigen::Index readings() const { return readings_; }
  Eigen::Index size() const { return readings_ + unknowns(); }
  Eigen::Index first(std::size_t piece) const { return first_[piece]; }
  Eigen::Index count(std::size_t piece) const { return 4 * static_cast<Eigen::Index>(pieces_[piece].count); }
  Eigen::Index start_column(std::size_t piece) const {
    return parameters() + kStates * static_cast<Eigen::Index>(piece);
  }

  // Computes the residuals and, if `jacobian` is not null, their derivatives by all unknowns, by central differences.
  // Returns false if the arm with these parameters cannot be simulated.
  bool fill(const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* jacobian) const;

  // Writes the most likely initial states, given the parameters in x, to x. Returns false if that fails.
  bool fit_starts(Eigen::VectorXd& x) const;

 private:
  Parameters robot_at(const Eigen::VectorXd& x) const;
  std::optional<Eigen::VectorXd> off(const Parameters& robot, const Eigen::VectorXd& x, std::size_t piece) const;
  bool fit_start(Eigen::VectorXd& x, std::size_t piece) const;
  std::optional<Eigen::VectorXd> slope(const Eigen::VectorXd& x, std::size_t piece, Eigen::Index column) const;
  bool fill_slopes(const Eigen::VectorXd& x, Eigen::MatrixXd& jacobian) const;

  const Parameters& known_;
  const Prior& prior_;
  const std::vector<ExecutedMotion>& motions_;
  const ForEach& for_each_;
  std::function<bool()> stopped_;
  Eigen::VectorXd steps_;
  Eigen::Vector4d noise_;
  std::vector<ReplayedPiece> pieces_;
  std::vector<Eigen::Index> first_;
  Eigen::Index readings_ = 0;
};

}  // namespace fjr
