// Motions to start the optimiser from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "planner/ocp/collocate.h"
#include "planner/ocp/guess.h"
#include "planner/problem/problem.h"
#include "planner/trajectory/motion.h"

namespace fjr {

// q on straight lines through start, via points and goal, theta in static equilibrium, at rest, zero torque.
Guess straight_guess(const Problem& problem, double duration);

// Minimum-jerk q between the same points, everything else by flatness. u is the torque without friction.
Guess minimum_jerk_guess(const Problem& problem, double duration);

// Passes start, via points and goal without stopping at them, by q in quintic polynomials of the time that jerk least,
// and everything else by flatness. It has the times and velocities of fastest_passing(). If the problem's bounds ask
// for a longer or shorter motion, velocities that are left open are smaller or larger by as much.
Guess passing_guess(const Problem& problem);

// Link angles one after the other [rad], with straight lines between.
using Path = std::vector<Joints<double>>;

// Follows one path per segment, with corners rounded; theta in static equilibrium, at rest, zero torque.
Guess path_guess(const Problem& problem, double duration, const std::vector<Path>& paths);

// Follows one path per segment at the pace of minimum jerk, everything else by flatness. Of a path's distance from the
// straight line between its ends, the first eight terms of a sine series are followed.
Guess smooth_path_guess(const Problem& problem, double duration, const std::vector<Path>& paths);

// The paths of the segments on which the tip keeps to the task's line or arc, where it has one.
std::vector<Path> paths_along_tip_path(const Problem& problem);

// The straight guess, displaced by a smooth random detour of the given size [rad]; the same seed gives the same guess.
Guess displaced_guess(const Problem& problem, double duration, double size, std::uint64_t seed);

// Another guess, displaced by such a detour; its springs stay as deflected as they were.
Guess displaced_guess(Guess guess, double size, std::uint64_t seed);

// Returns the guess with its links first moving back by this much [rad], in order to swing up from there.
Guess winding_up_guess(Guess guess, const Joints<double>& back);

// A guess for swinging up. Link 1 first goes back, and then past the angle where gravity takes most, with link 2 folded
// the same way; then link 2 unfolds. Thus an arm gets up with less torque than it takes to be held: gravity takes less
// torque of a folded arm, and link 2 pulls link 1 along while it folds and unfolds. Velocities are zero throughout.
// swing: [s] from the start to where the arm is folded.
Guess folding_guess(const Problem& problem, double duration, double swing);

// Returns the posture [rad] straight down, or the nearest to it within the joints' limits; none if gravity takes no
// torque.
std::optional<Joints<double>> hanging_posture(const Problem& problem);

// Swings through hanging straight down in the segment that lasts longest, because holding an arm up takes torque all
// the time, and swinging down and up again takes little. States and torques follow from flatness. Returns nothing if
// gravity takes no torque, or if hanging is hardly a detour.
std::optional<Guess> hanging_guess(const Problem& problem, double duration);

// In every segment first_joint (0 or 1) begins to move first and the other joint ends last. Friction holds the load of
// a resting motor, so that least-effort minima differ by which motor rests when. At rest throughout, zero torque.
Guess staggered_guess(const Problem& problem, double duration, std::size_t first_joint);

// Returns the guess with waits at its beginning and end, as fractions of the duration. The motion itself is compressed
// into the time between them.
Guess waiting_guess(Guess guess, double first, double last);

// Returns the guess with a pause [s] in it, which begins at this time [s]. It must have one segment.
Guess paused_guess(Guess guess, double begin, double pause);

// Returns a solved motion, with segments of these durations [s], stretched to `duration` [s].
Guess guess_from(Motion motion, const std::vector<double>& durations, double duration);

// Returns a solved motion likewise, as long as it is: a guess for a neighbouring problem.
Guess guess_of(Motion motion, const std::vector<double>& durations);
Guess guess_of(const Collocated& solution);

// Returns a guess's motion through its first `count` segments.
Guess first_segments_of(const Guess& guess, std::size_t count);

// Returns roughly how long [s] a motion takes: what a rigid arm takes within the limits of torque and velocities, times
// 1.3 for the fastest motion and 2 for others, because of springs and friction.
double usual_duration(const Problem& problem);

// A duration to start from: the usual one, clamped to the problem's bounds. [s]
double duration_guess(const Problem& problem);

}  // namespace fjr
