// Settings of the starts: which guesses are tried, in which order, and which of them are followed.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

namespace fjr {

// The list of guesses (starts.h).
struct StartSettings {
  int thorough = 4;             // times the usual number of starts for `search: thorough`
  double waiting = 0.4;         // fraction of the duration that a guess waits
  std::size_t further = 2;      // starts after the plain and the waiting ones, while none leads anywhere
  double longest_passing = 3;   // times as long as in the passing guess a segment may be in a first solve
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
  double barrier_after_bounds = 1e-4;  // where a guess was solved with bounded segments, and is solved without
};

// Which motions are followed along the homotopy (race.h).
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

}  // namespace fjr
