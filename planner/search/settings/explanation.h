// Settings of explanations: why a request cannot be had.
#pragma once

#include <array>
#include <cstddef>

namespace fjr {

// Problems whose optimum is the least change that makes a request feasible (slack.h).
struct SlackSettings {
  double most = 6;   // largest slack: nobody would build a robot with larger limits. Solves start at half of it.
  double loose = 3;  // fraction by which limits are relaxed to get the duration of the guesses
  double time_weight = 0.003;       // [1/s] of the regularisation: enough for the motion not to dawdle
  double larger_time_weight = 0.1;  // [1/s] with which the first solution has a bounded duration
  double longer = 2;                // times the duration of that solution, which the next one may take
};

// Whether a request is worth more starts (out_of_reach.h).
struct OutOfReachSettings {
  // Fraction of the least time by which a via point comes too early: smoothed motions are some per cent slower.
  double clearly_early = 0.05;
  double clearly_more = 0.5;    // fraction by which all limits would have to be larger
  double clearly_slower = 0.5;  // fraction by which a velocity alone would have to be smaller
  double much_faster = 2;       // times the motors' limits, beyond which a link's velocity is too fast
};

// Solves for explanations and for the question whether a request is out of reach (search.h).
struct ExplanationSolveSettings {
  double budget = 10;             // [s] of work (SolveReport::work), for one explanation
  int iterations = 450;           // of one start
  int iterations_of_slack = 250;  // of one that minimises a slack: those that lead somewhere took up to 190
  // Of one that minimises a slack from the fastest motion: of 238 that led somewhere none took more.
  int iterations_from_fastest = 150;
  double longest_on_full_mesh = 1;  // [s] motions that take longer are begun with as many intervals as one of this
  // Times the base margin, by which the last round may leave a limit exceeded: a margin that a certificate asks for
  // takes it away.
  double exceeded = 2;
  std::size_t guesses = 2;  // of the usual ones
};

// Why a request cannot be had, and the least that would have to change (explain.h).
struct ExplanationSettings {
  ExplanationSolveSettings solves;
  std::size_t candidates = 6;            // limits that are looked at
  std::size_t candidates_at_a_time = 2;  // that are tried beside each other
  double in_the_way = 0.05;              // fraction of the slack by which what is in the way exceeds its limit
  // If this many times the duration of a motion with everything relaxed is allowed, there is time to carry the arm.
  // With just the torque that carrying takes, swing-ups to 2.2, 2.6 and 3 rad take 1.06 times as long.
  double time_to_carry = 3;
  // Fraction of a change that is added to it: the least change leaves exactly one feasible motion, which cannot be
  // refined or given margins.
  double margin = 0.01;
  double rough_margin = 0.1;     // in place of that, if friction is still smoothed
  double combined_margin = 0.1;  // likewise, of two changes that together are only just enough
  // Fraction of a shortest duration that is added to it, so that a request for it has a plan.
  double duration_margin = 2e-4;
  double spare_time = 0.01;  // likewise, for objectives other than time
  // Factors on the least change, tried in this order until planning succeeds.
  std::array<double, 6> retries{1, 1.03, 1.1, 1.25, 1.5, 2};
  std::array<double, 3> trials{0.02, 0.05, 0.1};  // fractions of what is changed, where hardly any change is needed
  double slack_worth_exact_friction = 0.05;       // of a sketch, below which an exact solution may need none
  double negligible_slack = 2e-3;                 // below it the request is possible, as far as a sketch can tell
  // Fraction of all limits at once, beyond which those that would then exceed the robot's are not tried alone.
  double slack_beyond_single_limits = 0.25;
  double large_change = 1;                  // of one limit, as a fraction of its size
  double barred_margin = 1.1;               // times the clearance that a grid found missing
  std::array<double, 3> widths{1, 1.5, 2};  // times that, tried in this order until there is a path and a motion
  double time_tolerance = 0.02;             // fraction of a change of time to which it is found
  double no_change = 1e-3;                  // fraction of a time that is no change of it
  std::size_t more_rows = 1000;             // that a torque with jumps takes beside the regular ones
};

}  // namespace fjr
