// Closed-loop rollouts from perturbed starts.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "planner/certificate/certificate.h"

namespace fjr {

// Returns half a count of the link encoder [rad]: the arm may be that far off the start while the encoder reads the
// start.
double start_offset(const Parameters& p, std::size_t joint);

// Rolls the trajectory out in closed loop from five starts with the whole arm, links and motors, off its first row: by
// start_offset() in either joint, all four combinations of signs, and by a thousandth of that in both. If the plan
// rests on the way, the executor holds the arm from each state reached at the beginning of the rest, with its ticks and
// the counts of the encoders, as it does after an end at rest.
class PerturbedRollouts {
 public:
  static constexpr std::size_t kStarts = 5;

  // Both must outlive it.
  PerturbedRollouts(const Parameters& p, const Trajectory& trajectory);

  // Rolls out from one of the starts; start < kStarts. Different starts may be rolled out on different threads.
  void roll_out(std::size_t start);

  // The largest errors of all. Call when all have been rolled out.
  Perturbed worst() const;

 private:
  // A stretch in which the plan stays at one place, long enough for the executor's dither to begin.
  struct Rest {
    Sample row;             // the first of it
    double to;              // [s]
    State<double> reached;  // by the rollout, at its beginning
  };
  static std::vector<Rest> rests_in(const Parameters& p, const Trajectory& trajectory);

  const Parameters& p_;
  const Trajectory& trajectory_;
  std::vector<double> instants_, corners_;  // [s]
  std::vector<Rest> rests_;                 // without what is reached
  std::array<Perturbed, kStarts> from_;
};

// Rolls out all of them, one after another.
Perturbed roll_out_perturbed(const Parameters& p, const Trajectory& trajectory);

}  // namespace fjr
