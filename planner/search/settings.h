// Constants that tune the search, one struct per algorithm: each with its unit, what it does, and where there is
// one the measurement behind it. An expert sets them by PlanOptions::search, or in a file (settings_file.h); a plan is
// a function of them as of its request, whose hash does not contain them. (Guesses and paths round obstacles are
// functions of the problem alone: what shapes them stands in guesses.cc, clear_guesses.cc and detours.cc. The steps of
// the homotopy are in continuation_strategy.cc, and how margins, rests and moving nodes are set up in planner/ocp. What
// says how exactly something is computed, such as the points of a quadrature, stays where that is done.)
#pragma once

#include "planner/search/settings/continuation.h"
#include "planner/search/settings/explanation.h"
#include "planner/search/settings/fallbacks.h"
#include "planner/search/settings/refining.h"
#include "planner/search/settings/starts.h"

namespace fjr {

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

struct SearchSettings {
  ContinuationSettings continuation;
  StartSettings starts;
  StartOrderSettings order;
  FollowSettings follow;
  RaceSettings race;
  FallbackSettings fallbacks;
  StepwiseSettings stepwise;
  SwingUpSettings swing_up;
  SpareTimeSettings spare_time;
  FastestSettings fastest;
  AccelerationPenaltySettings acceleration_penalty;
  PublicationSettings publication;
  TrackingSettings tracking;
  RobustSettings robust;
  SlackSettings slack;
  OutOfReachSettings out_of_reach;
  ExplanationSettings explanation;
  BudgetSettings budget;
};

}  // namespace fjr
