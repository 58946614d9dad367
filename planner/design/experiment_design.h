// Motions that tell an arm's parameters as well as motions within its limits can.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/parallel.h"
#include "planner/identify/prior.h"
#include "planner/request/request.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

inline constexpr double kLongestDesign = 120;  // [s]

struct DesignOptions {
  Joints<double> start{};                        // [rad] link angles where the first motion begins
  double duration = 20;                          // [s] of all motions together, at most
  int candidates = 16;                           // that are planned for each motion; the best of them is taken
  std::uint64_t seed = 1;                        // of the candidates
  std::function<void(double done)> on_progress;  // fraction of the duration
  std::function<bool()> cancelled;               // polled, from several threads at once where for_each has them
};

struct DesignedMotion {
  Request request;
  Trajectory trajectory;  // its plan, certified
};

struct ExperimentDesign {
  std::vector<DesignedMotion> motions;  // from rest to rest, each from where the one before ends
  Eigen::VectorXd error;                // predicted standard errors after them, in the order of the prior's names

  double duration() const;  // [s]
};

// A chain of motions after which the prior's parameters are known best. Candidates are fastest motions to random
// postures, half of them at a fraction of the motors' speed, for friction near standstill; of each round the one is
// taken that adds most to the logarithm of the determinant of Fisher's information for each second that it takes
// (D-optimal, one after the other: Fedorov, Theory of Optimal Experiments, 1972, ch. 4), with planned_information()
// for what a motion tells. The same options give the same design, whatever for_each does with its pieces of work.
// Throws InputError where the arm cannot rest at the start, or no motion from there can be planned.
ExperimentDesign design_experiment(const Parameters& robot, const Prior& prior, const DesignOptions& options,
                                   const ForEach& for_each = one_after_another);

}  // namespace fjr
