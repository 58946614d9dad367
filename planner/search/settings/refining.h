// Settings of what becomes of a solution: it is published, made insensitive, and given margins.
#pragma once

#include <cstddef>

namespace fjr {

// Rounds of refining one solution until it is certified (publication.h).
struct PublicationSettings {
  int rounds = 8;
  double finer_rows = 0.25;  // factor on the allowed interpolation error, each round
  // Rounds in which nothing but a finer mesh and finer rows are tried against what rollouts amplify. In later ones
  // limits that only the rollout exceeds get margins, and rests are shorter by the next factor. Slow motions pass
  // standstill for so long that friction shakes the arm by more than 0.1 % of the limit on their velocity: one of 17 s
  // was not certified with up to 2235 intervals, and is with 0.3 % less speed.
  int rounds_by_accuracy = 2;
  // Factor on CreepSettings::shortest_rest in these later rounds. A motor that passed through its unstable band in 35
  // ms amplified errors to 1.1 counts, which no finer mesh made less; with 10 ms it is certified for 0.08 % of the
  // objective.
  double shorter_rests = 0.25;
};

// Motions that errors of the arm's parameters disturb less (tracking.h).
struct TrackingSettings {
  double worthwhile = 1e-3;  // fraction of the objective, that a round gains
  int stalled = 3;           // consecutive rounds that gain less, or nothing, until the search ends
  // Weight of the quadratic term, in units of the price: what it adds if every state is off all the time by the root
  // mean square of its own motion.
  double first_stiffness = 1, least_stiffness = 1e-3, most_stiffness = 1e3;
  // A round that gains more than the fraction `trusted` of what it predicted divides the next one's weight by `softer`;
  // one that gains less than `distrusted` multiplies it by `stiffer`.
  double softer = 3, stiffer = 4;
  double trusted = 0.75, distrusted = 0.25;
  double least_variance = 1e-4;  // [rad^2, rad^2/s^2] of joints that hardly move
};

// Margins for the arms that an identification leaves possible (robust.h).
struct RobustSettings {
  int fitting_rounds = 5;    // two or three are enough where margins move as little as they usually do
  double wider = 1.05;       // factor on margins, because the motion they lead to has others
  std::size_t pieces = 200;  // of the motion, in which margins are constant
  double patience = 4;       // times the usual iterations, of which one solve took 199
};

}  // namespace fjr
