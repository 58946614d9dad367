// Settings of the continuation: from a guess to a converged solution (continuation.h).
#pragma once

#include <cstddef>

namespace fjr {

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

// The steps from a smoothed friction law to the exact one. Their widths are in continuation_strategy.cc.
struct HomotopySettings {
  double mesh_tolerance = 1e-5;      // [rad] during the homotopy
  int iterations = 80;               // of steps that converge at all, nine of ten take less than 60
  int iterations_of_shift = 150;     // where the law only shifts the torque limits (bench/README.md, Fastest motions)
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
  // and their objectives are up to 1.5 % higher. If no step of a homotopy has this width, nodes only move with the
  // exact law.
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
  // that time. A switch of the torque inside an interval costs time in proportion to the interval's length, and the
  // error of the interval falls with a higher power of it, so that in short motions one error for all leaves intervals
  // too long: with it, fastest motions of 0.08 to 0.1 s took up to 2.5 % longer than they had to. With 0.7 s in place
  // of 0.35, durations of 0.2 to 0.5 s come to 0.02 % less, and take half as long again to find (bench/README.md).
  double full_tolerance_from = 0.35;
  double least_part_of_tolerance = 0.01;  // reached at a fifth of that; solves are not much more exact
  double shortest_interval = 2.5e-4;      // [s] refinement stops there: a switch inside costs less than the tolerance
  // [s] Shorter intervals are not split to lower a peak of the torque, but have a margin. Splitting would not end,
  // because the reversal of the motor, where the peak is, then moves into the next interval. Peaks are up to 3 % higher
  // with 2.5 ms, and 17 % with 5 ms.
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

// Motors whose rest is unstable are kept moving (creep.h).
struct CreepSettings {
  int probes = 8;               // of an interval, by which a motor is found to rest
  double shortest_rest = 0.04;  // [s] shorter ones are over before the deviation has grown to a count
  // Times the velocity at the band's edge, where the law's slope is zero: here it is clearly positive.
  double faster = 2;
};

struct ContinuationSettings {
  FirstSolveSettings first;
  WarmStartSettings warm;
  HomotopySettings homotopy;
  NodeTimeSettings nodes;
  RegularisationSettings regularisation;
  MeshSettings mesh;
  TighteningSettings tightening;
  CreepSettings creep;
};

}  // namespace fjr
