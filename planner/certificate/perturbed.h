// The closed loop from elsewhere than exactly the start.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "planner/certificate/certificate.h"

namespace fjr {

// Half a count of the link encoder: that far the arm may be off the start while the encoder reads the start. [rad]
double start_offset(const Parameters& p, std::size_t joint);

// The trajectory rolled out in closed loop from five starts with the whole arm, links and motors, off its first row: by
// start_offset() in either joint, all four combinations of signs, and by a thousandth of that in both. Where the plan
// rests on the way, the executor holds the arm from where it came to, with its ticks and the counts of the encoders, as
// it does after an end at rest, from where each of them ended.
class PerturbedRollouts {
 public:
  static constexpr std::size_t kStarts = 5;

  // Both must outlive it.
  PerturbedRollouts(const Parameters& p, const Trajectory& trajectory);

  // From one of the starts, below kStarts. Different starts may be rolled out on different threads.
  void roll_out(std::size_t start);

  // The largest errors of all. Call when all have been rolled out.
  Perturbed worst() const;

 private:
  // Where the plan stays at one place, for long enough that the executor's dither begins.
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

// All of them, one after another.
Perturbed roll_out_perturbed(const Parameters& p, const Trajectory& trajectory);

}  // namespace fjr
