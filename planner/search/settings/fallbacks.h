// Settings of what is tried beside the usual starts, and where they lead nowhere.
#pragma once

#include <array>
#include <cstddef>

namespace fjr {

// What is tried where no start leads anywhere (fallbacks.h).
struct FallbackSettings {
  int iterations = 300;                // of one attempt
  int patient_iterations = 1200;       // motions that have to swing up took up to 630
  double patient_regularisation = 10;  // times the usual regularisation
  std::size_t patient_starts = 2;
  double coarser = 0.5, finer = 2;        // times the usual number of intervals
  std::array<double, 2> relaxed{0.5, 3};  // fractions by which limits are relaxed at first
};

// Limits are tightened step by step, each solution starting the next.
struct StepwiseSettings {
  int iterations = 600;            // of a step after which the motion swings once more
  double longest_interval = 0.03;  // [s] mean interval up to which a mesh is reused for a longer motion
  double first_step = 0.05;        // of the factor on the limits, relative
  double longer_step = 1.25;       // times the last step, after a success
  double growth = 0.06;            // fraction by which a step may make the motion longer, going by the last one
  double shortest_step = 2e-4;     // below this, failed steps are not halved again
  // If more work is allowed than usual, the iteration limits of swinging motions grow in proportion, up to this factor:
  // with little torque to spare, warm starts take up to 690 iterations.
  double most_patience = 5;
  // Factors on the usual friction width. A slowly moving motor has less friction under a smoothed law, so a swing-up
  // found with the usual width may be infeasible with the exact law. With the sharpest law, limits are tightened in
  // more and longer steps.
  double sharp_width_factor = 0.1, sharpest_width_factor = 0.01;
};

// Motions that swing an arm up that its torques cannot carry.
struct SwingUpSettings {
  double easily_carried = 1.05;                   // times what carrying the arm takes
  std::array<double, 3> winding_up{0.4, 0.2, 0};  // fractions of the way that links go the other way first
  // If carrying the arm takes more than this many times the torque of joint 1, tightening the limits step by step takes
  // ever shorter steps: with 5.6 of 6.7 N m (1.196 times) it took 2,300 iterations, with 5.5 it never arrived.
  double much_too_heavy = 1.205;
  std::array<double, 3> durations{2.3, 3.4, 4.5};  // that are tried, in periods of small oscillations
  double swing = 1.5;                              // in these periods, until link 1 is past where gravity takes most
  double mesh_factor = 0.6;                        // times the usual number of intervals
  // Missing fraction of the torque beyond which more time is not tried: twice what it gains.
  double hopeless_slack = 0.03;
  double negligible_slack = 1e-3;  // fraction of the torque: as good as none
  // Fraction of the torque that is reported as missing if a swing-up is found but no plan comes of it.
  double reported_deficit = 0.01;
  int iterations = 650;             // those that lead somewhere took up to 590
  int shortenings = 2;              // rounds that shorten the swing-up, if the fastest motion is far off
  int shortening_iterations = 500;  // those that lead somewhere took 290 to 410
  int last_iterations = 900;        // of the last attempt
  double patience = 2;              // times the usual iterations of warm starts
};

// Long motions of least torque, which are looked for as shorter ones (spare_time.h).
struct SpareTimeSettings {
  // [s] Duration of the shorter motion if the arm waits at its start or goal, and if it pauses on the way, the pause
  // apart; but no less than a multiple of the usual duration. Of one way effort in 1.5 s is within 0.1 % of that in 10.
  double one_motion = 2.5, two_motions = 2.5;
  double times_usual = 1.5;
  double worthwhile = 1.6;  // times that duration, from which on a request has time to spare
  // [s] Shortest duration if accelerations are paid for too. Of eight such motions of 5 to 20 s one came to 0.5 % less
  // with a wait, and all took 1.3 to 1.8 times as long; of 40 s and more none is found without.
  double accelerations_from = 25;
  double pause = 0.2;  // [s] of the shorter motion's pause
  // [rad/s] At this speed joint 1 has nine tenths of the friction that holds it. With 0.003 rad/s in place of it pauses
  // cost up to 3 % less, but few of them could be made longer: joint 2 moves too far in them.
  double speed = 2e-4;
  double hardly_moving = 0.01;  // [rad/s] at which friction holds an arm that waits at its start or goal
  double costly_wait = 1.01;  // times the objective of the motion without it, up to which a wait costs hardly anything
  // Intervals of the wait, before they are refined. With 8 in place of 32 half of the waits at an end came to nothing
  // when they were; a pause, in which motors are slow, needs no more.
  std::size_t intervals_at_end = 32, intervals_of_pause = 8;
  int iterations = 400;  // of the solve with the wait, which has no multipliers to begin with
  // A pause begins close to its bounds, because its motors have the velocities at which friction holds them.
  double barrier_at_end = 0.1, barrier_of_pause = 1e-4;
  // [rad/s] of the second friction law from which a wait is solved.
  double width_at_end = 0.1, width_of_pause = 3e-4;
};

// The fastest motion of a request (fastest.h).
struct FastestSettings {
  double hardly_more = 1.05;  // times the shortest duration, up to which there is hardly any time to spare
};

// Penalties on the links' acceleration and jerk, against oscillation (acceleration_penalty.h).
struct AccelerationPenaltySettings {
  double time_to_oscillate = 2;  // [s] motions that last at least this long have time to oscillate
  // [s^4/rad^2] weight in an objective that is divided by its size. Minimum-energy motions of 3 to 8 s need 0.1 % more
  // energy with it. With ten times as much, the peak torque of a motion of 5 s was higher, and did not come down when
  // the weight was reduced.
  double weight = 1e-4;
  double less = 0.3;  // factor on the weight in each step of fading it; after all of them it costs less than 0.02 %
  int steps = 5;
  // Of damping, for motions that come to no plan otherwise: what a smooth motion pays, as a fraction of the objective.
  // Of 16 slow motions (8 to 32 s, most with a tip speed close to what they need) 10 were certified with this fraction,
  // 6 with 0.2.
  double part_of_objective = 0.03;
  // Factor on that in each step of taking it back, until one leads to nothing better; then `less`. With `less` alone
  // least effort in 30 s comes down to 76 in place of 51 N^2 m^2 s within the same work.
  double damping_factor = 0.1;
  // [s^4/rad^2], [s^6/rad^2] of long minimum-time motions. The penalty on acceleration damps the springs; it makes a
  // motion of 30 s 0.2 % longer. The penalty on jerk also damps the motors, because the executor's feedback cannot
  // follow their oscillation where they reverse slowly; it costs another 0.05 %. Of ten motions of 6 to 75 s that are
  // limited by the tip speed or motor velocities, the first variant (both) certified eight and the second one (less
  // jerk) another.
  double fastest_acceleration = 0.01, fastest_jerk = 1e-5;
  double less_jerk = 10;  // divisor of the second variant
};

}  // namespace fjr
