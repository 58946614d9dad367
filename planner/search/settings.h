// Constants that tune the search, one struct per algorithm: each with its unit, what it does, and where there is
// one the measurement behind it. An expert sets them by PlanOptions::search; a plan is a function of them as of its
// request, whose hash does not contain them. (What shapes guesses and paths, the price of tracking errors, margins for
// other arms and explanations have theirs at the top of their files.)
#pragma once

#include <array>
#include <cstddef>
#include <limits>

namespace fjr {

// ---- continuation: from a guess to a converged solution (continuation.h) ----

// The first solution from a guess, on a coarse mesh with the smoothest friction law.
struct FirstSolveSettings {
  // The intervals of the first mesh must be short enough for the first solution to have the right shape: the springs
  // oscillate at up to 50 rad/s.
  double interval = 0.02;                    // [s]
  double interval_among_obstacles = 0.0075;  // [s] longer intervals jump over obstacles (though not over walls)
  double most_among_obstacles = 160;         // intervals: enough for a motion through all of the arm's reach
  // The same where the objective sees friction: motions that are not in a hurry, begun clear of obstacles.
  double interval_without_hurry = 0.0125;  // [s]
  double most_without_hurry = 100;
  int fewest_intervals = 25, most_intervals = 400;
  int intervals_per_via = 2;  // in addition
  // Relative difference of objectives on one mesh below which minima are one.
  double same_minimum = 2e-5;
  // Times the least known objective, on coarse meshes, beyond which a start is not followed. Of 318 starts beyond this
  // factor none became the best motion of its request; of 510 beyond a factor of 1.1 two did.
  double hopeless = 1.2;
  // A start at its iteration limit goes on if its objective is below all known minima and its constraints nearly hold.
  // This was so for four of 490 starts of 41 motions, one of which ended at less than half of all others.
  int iteration_factor_when_ahead = 3;  // times the iterations of others
  double small_violation = 1e-2;        // violation of constraints up to which an objective says something
};

// Solves from an earlier solution and its multipliers.
struct WarmStartSettings {
  int iterations = 150;  // at most
  // A warm start begins as close to its bounds as the last solution is. A larger barrier first has to push it away from
  // them; a smaller one makes it crawl along them. 1e-7 took the fewest iterations of 1e-5 ... 1e-9, and costs 0.05 %
  // of the time in a minimum-time problem (the barrier times the number of bounds).
  double barrier = 1e-7;
  int iterations_to_another_price = 250;  // at most: switching times and active limits change
  // A solve that stops at its iteration limit goes on if its objective has fallen by this fraction.
  double worthwhile_decrease = 0.005;
  int more_iterations = 200;  // in all then: up to 4 % less effort
};

// The steps from a smoothed friction law to the exact one. Their widths are in continuation_strategy.h.
struct HomotopySettings {
  double mesh_tolerance = 1e-5;      // [rad] during the homotopy
  int iterations = 80;               // of steps that converge at all, nine of ten take less than 60
  int iterations_with_reward = 300;  // those with a reward converge more slowly (bench/README.md)
  int iterations_with_rests = 50;    // with rests scaled, 45
  double rest_width = 0.003;         // [rad/s] up to which rests are scaled: in wider laws a moving motor seems to rest
  int halvings = 2;                  // of a step that did not converge
  double sharp_width = 1e-4;         // [rad/s] as good as the exact law, where a step is halved
};

// The nodes at which the Hamiltonian jumps are moved to their optimal times.
struct NodeTimeSettings {
  int iterations = 60;  // nine of ten take less than 45
  // [rad/s] width of the homotopy step after which nodes are moved for the first time, because from then on it is
  // settled when each motor rests. If nodes move only with the exact law, the comparison of motions depends on chance,
  // and their objectives are up to 1.5 % higher.
  double first_width = 0.01;
  int rounds = 2;  // a refined mesh wants its nodes elsewhere, but no longer by much
};

// The regularisation by effort is reduced where it would outweigh the objective.
struct RegularisationSettings {
  double largest = 0.05;         // fraction of the objective; its cost is of second order in that
  double decrease = 0.5;         // fraction of this to which it is reduced
  double largest_change = 1e-3;  // least factor by which one round reduces it
  int rounds = 4;
};

// Where intervals of the mesh are split.
struct MeshSettings {
  double tolerance = 3e-6;  // [rad] error of an interval; some hundred of them stay within half a count together
  // Between given velocities that are less than this [s] apart the allowed error is smaller, by the cube of
  // that time: with the intervals' lengths their errors fall faster than what a switch between two nodes costs. With
  // one error for all, fastest motions of 0.08 to 0.1 s took up to 2.5 % longer than they had to. With 0.7 s in place
  // of 0.35, durations of 0.2 to 0.5 s come to 0.02 % less, and take half as long again to find (bench/README.md).
  double full_tolerance_from = 0.35;
  double least_part_of_tolerance = 0.01;  // reached at a fifth of that; solves are not much more exact
  double shortest_interval = 2.5e-4;      // [s] refinement stops there: a switch inside costs less than the tolerance
  // [s] Shorter ones are not split for a peak of the torque, but have margins: a motor's reversal moves on into the
  // next interval, and would be followed from one to the other. With 2.5 ms peaks are up to 3 % higher, with 5 ms 17 %.
  double shortest_interval_for_peak = 1.2e-3;
  // Most intervals of a mesh; fewer if a task adds rows. Memory grows with them, by 70 kB an interval without a task.
  std::size_t most_intervals = 2500;
  double rows_without_task = 20;  // of an interval, to which those of a task are added
  double looser = 1.5;            // factor on the tolerance while the mesh would have too many intervals
  double cost_tolerance = 3e-5;   // fraction of the objective by which an interval may misjudge it
  // Excess over a limit, as a fraction of it, beyond which intervals are split, because a margin would usually cost
  // more.
  double excess_worth_splitting = 0.02;
  double excess_worth_quartering = 4;  // times that
  double error_when_splitting = 1.5;   // times the tolerance: what an interval counts as that is split for its excess
  // Where a certificate asks for smaller errors, the intervals with the largest ones are split, down to where those
  // that are not make up this fraction of the sum of all errors.
  double others_of_sum = 0.2;
};

// Margins and mesh are adapted until every limit holds between the collocation points.
struct TighteningSettings {
  int rounds = 8;
  // Tolerances of a round that another one follows, if the objective does not depend on friction or is a peak: the last
  // iterations of a round hardly change the errors by which mesh and margins are judged. Solved to the end, ten fastest
  // motions took 1.13 times as many iterations times intervals (a reach 1.4 times).
  double round_tolerance = 1e-4, round_violation = 1e-7;
  int failures = 3;  // then it is given up: further attempts fail alike, with 300 iterations each
  // The first rounds keep the whole base margin. Later ones keep a fifth of it: by then the motion is inside the
  // limits, and keeping more takes rounds in which nothing changes.
  int rounds_of_whole_margin = 2;
  double later_part_of_margin = 0.2;
  double growth = 2;               // least factor of a margin that did not suffice
  double ineffective_growth = 8;   // of one that changed nothing: its bound was not active
  double sharp_for_peaks = 0.004;  // [rad/s] widths of friction laws up to which peaks are kept by margins
  // Rounds of each tightening that split intervals for a peak; later ones widen margins alone. When all rounds did, a
  // motor that trembles about its rest got 1100 intervals, and a peak that was 16 % too high.
  int rounds_of_splitting_for_peak = 2;
  int creep_rounds = 3;  // what is kept out of one interval may settle in the next
};

struct ContinuationSettings {
  FirstSolveSettings first;
  WarmStartSettings warm;
  HomotopySettings homotopy;
  NodeTimeSettings nodes;
  RegularisationSettings regularisation;
  MeshSettings mesh;
  TighteningSettings tightening;
};

// ---- race: which motions are followed along the homotopy (race.h) ----

struct RaceSettings {
  double same_minimum = 1e-4;  // relative difference of objectives below which minima are not told apart
  // Relative distance from the best objective that the steps after one of a wider friction law than `width` [rad/s] may
  // make up. The first entry that applies counts; they begin with the widest. With these distances, 33 motions from 12
  // starts each came within 0.02 % of the results with larger ones (bench/README.md).
  struct Gap {
    double width, distance;
  };
  std::array<Gap, 3> gaps{{{0.03, std::numeric_limits<double>::infinity()}, {0.01, 0.02}, {0.003, 0.004}}};
  double last_gap = 0.003;             // of sharper laws
  double gap_without_friction = 0.02;  // of objectives that do not depend on friction
};

// ---- starts: which guesses are tried, in which order, and which of them are followed ----

// The list of guesses (starts.h).
struct StartSettings {
  int thorough = 4;             // times the usual number of starts for `search: thorough`
  double waiting = 0.4;         // fraction of the duration that a guess waits
  std::size_t further = 2;      // starts after the plain and the waiting ones, while none leads anywhere
  double throwing_speed = 0.7;  // fraction of the motors' speeds that guesses of throws have at the release
  double far_away = 0.8;        // [rad] that straight guesses are displaced by
  int for_neighbour = 4;        // starts that a neighbouring problem is worth
  std::size_t most_paths = 3;   // round the obstacles of one segment
  // Where there are obstacles and the objective sees friction, minima are many, and a start near another motion seldom
  // leads nowhere: so many starts in addition, and near the best motion so far instead of far from all.
  int more_among_obstacles = 6;
  std::size_t near_the_best_among_obstacles = 6;
  double another_end = 0.1;       // [rad] between ends of a free joint that are not the same
  double end_by_distance = 1e-3;  // [1/rad] of easy ends, beside squares of torques, as fractions of their limits
};

// The order in which starts are tried, and when something else is (motions.h).
struct StartOrderSettings {
  // Starts at a time, once one has found a motion. More of them use more cores, but cannot use each other's results.
  // The number is fixed, so that the plan does not depend on the number of cores.
  std::size_t at_a_time = 4;
  double near_by = 0.3;  // [rad] that the best motion so far is displaced by: minima lie side by side
  int given_up = 2;      // failed starts after which an alternative is given up, if another one led somewhere
  std::size_t before_swinging = 1;  // failed starts before swing-ups are tried and reachability is checked
  std::size_t before_fastest = 2;   // failed starts before the fastest motion is looked for in any case
  // Failed starts before a sketch tells whether the fastest motion is looked for earlier; none if there is clearly
  // little time.
  std::size_t before_sketching_fastest = 1;
  double little_time = 0.7;  // fraction of the usual duration
};

// Which solutions on coarse meshes are refined to the end (follow.h).
struct FollowSettings {
  int iterations = 400;        // of a start, until one has converged
  int least_iterations = 100;  // of a start after one that converged
  int slower = 2;              // times the iterations of the one that converged soonest
  // How far refining may move an objective, relative to the best, and how many solutions are refined. If the objective
  // depends on friction, objectives with smoothed friction do not tell the final order: of seven motions the fourth
  // came to 3 % less effort than the first, so several are refined.
  double within = 0.02, within_with_friction = 0.05;
  int most = 3, most_with_friction = 5;
  double long_motion = 8;  // [s] Coarse meshes of longer motions do not resolve the oscillation of the springs.
  // Times the longest duration, beyond which a long fastest motion is not refined.
  double far_too_long = 1.15;
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

// Rounds of refining one solution until it is certified (publication.h).
struct PublicationSettings {
  int rounds = 6;
  double finer_rows = 0.25;  // factor on the allowed interpolation error, each round
};

// Fractions of a request's work that may be done by the end of a phase (session.h); others may use it all.
struct BudgetSettings {
  double finding = 0.5, refining = 0.8;
  // Where no start led to a motion, fallbacks may take this in addition. By then starts have often used up their own:
  // least peak torque in 5 s and a slow motion were not converged, and are certified with it.
  double fallbacks = 0.5;
  // Damping may use more than the others together, for by then they have used it all. Slow motions that can be had in
  // this way are certified in 5 to 15 s of one core.
  double damping = 1.4;
};

// ---- fallbacks: what is tried where no start leads anywhere (fallbacks.h) ----

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
  double pause = 0.2;       // [s] of the shorter motion's pause
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

struct SearchSettings {
  ContinuationSettings continuation;
  RaceSettings race;
  StartSettings starts;
  StartOrderSettings order;
  FollowSettings follow;
  AccelerationPenaltySettings acceleration_penalty;
  PublicationSettings publication;
  BudgetSettings budget;
  FallbackSettings fallbacks;
  StepwiseSettings stepwise;
  SwingUpSettings swing_up;
  SpareTimeSettings spare_time;
};

}  // namespace fjr
