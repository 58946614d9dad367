// Readings of executed motions off an arm whose parameters and starts are unknown, and their slopes.
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

// The arm whose parameters are off by that much, in the order of the names; without the bounds of changed(): a mass
// below none is a mean to find one that is hardly there.
Parameters moved(const Parameters& known, const std::vector<std::string>& names, const Eigen::VectorXd& by);

// All motions at one arm, in pieces. Unknown are the prior's independent numbers z, then what each piece begins off its
// guess, in units so large that the readings alone decide. Residuals are the readings of each piece, in standard
// deviations of a count, then the unknown themselves. What it is made of has to outlive it. stopped: asked before every
// rollout; from then on there is nothing.
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

  // Residuals, and where wanted their slopes by all unknowns, by central differences. False: there can be no such arm.
  bool fill(const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* jacobian) const;

  // The most likely starts with these parameters, into x.
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
