#include "planner/search/race.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace fjr {
namespace {

// Relative distance from the best objective that the steps after this width [rad/s] may make up.
double gap_after(double width, bool sees_friction, const RaceSettings& settings) {
  if (!sees_friction) return settings.gap_without_friction;
  for (const RaceSettings::Gap& gap : settings.gaps) {
    if (width > gap.width) return gap.distance;
  }
  return settings.last_gap;
}

enum class Place {
  kOnTheWay,  // it has steps left
  kAtTheEnd,  // no step is left, or the last one failed
  kArrived,   // settled
  kStopped,   // by the session, before it had settled
  kDropped,   // the same as another one, or too far behind
  kIgnored,   // its last piece of work is not counted
};

struct Runner {
  Continuation motion;
  Place place = Place::kOnTheWay;

  double objective() const { return motion.solution().report.objective; }
};

Place after_step(Continuation& motion) {
  return motion.take_step() == StepOutcome::kTaken ? Place::kOnTheWay : Place::kAtTheEnd;
}

Place after_settling(Continuation& motion) {
  return motion.settle() == Completion::kFinished ? Place::kArrived : Place::kStopped;
}

// Each motion is compared only with those that were found before it: then additional starts never change which of the
// earlier motions are followed.
void drop_losers(std::vector<Runner>& runners, StepObjectives& reached, const RaceSettings& settings) {
  for (Runner& runner : runners) {
    if (runner.place != Place::kOnTheWay) continue;
    const Smoothing& step = runner.motion.solution().setup.smoothing;
    const double width = step.friction_width;
    std::vector<double>& before = reached[{width, step.regularisation}];
    const bool depends_on_friction = sees_friction(runner.motion.problem()->weights);
    if (!worth_following(runner.objective(), width, before, depends_on_friction, settings)) {
      runner.place = Place::kDropped;
    }
    before.push_back(runner.objective());
  }
}

// Calls `work` for the motions of all runners at this place, in parallel. It returns where they are then.
void all_move(Place from, Place (*work)(Continuation&), std::vector<Runner>& runners, Session& session) {
  std::vector<Runner*> at_work;
  for (Runner& runner : runners) {
    if (runner.place == from) at_work.push_back(&runner);
  }
  const std::vector<PieceOfWork> pieces = session.do_all(at_work.size(), [&](std::size_t i, Session& own) {
    at_work[i]->motion.go_on_in(own);
    at_work[i]->place = work(at_work[i]->motion);
  });
  for (std::size_t i = 0; i < at_work.size(); ++i) {
    if (pieces[i] == PieceOfWork::kIgnored) at_work[i]->place = Place::kIgnored;
    at_work[i]->motion.go_on_in(session);
  }
}

}  // namespace

bool worth_following(double objective, double width, const std::vector<double>& others, bool sees_friction,
                     const RaceSettings& settings) {
  const double gap = gap_after(width, sees_friction, settings);
  const double scale = std::abs(objective);
  return std::none_of(others.begin(), others.end(), [&](double other) {
    return std::abs(objective - other) <= settings.same_minimum * scale || objective > other + gap * scale;
  });
}

Raced race(std::vector<Continuation> motions, StepObjectives& reached, Session& session) {
  std::vector<Runner> runners;
  for (Continuation& motion : motions) runners.push_back({std::move(motion)});
  // Where the objective depends on friction, motions with the same objective on refined first meshes lead to the same
  // minimum: all but the first of them are dropped here.
  const RaceSettings& settings = session.settings().race;
  if (!runners.empty() && sees_friction(runners.front().motion.problem()->weights)) {
    drop_losers(runners, reached, settings);
  }
  const auto is_on_the_way = [](const Runner& runner) { return runner.place == Place::kOnTheWay; };
  while (std::any_of(runners.begin(), runners.end(), is_on_the_way)) {
    all_move(Place::kOnTheWay, after_step, runners, session);
    drop_losers(runners, reached, settings);
  }
  all_move(Place::kAtTheEnd, after_settling, runners, session);
  Raced raced;
  for (Runner& runner : runners) {
    if (runner.place == Place::kArrived) raced.arrived.push_back(std::move(runner.motion));
    if (runner.place == Place::kDropped) raced.dropped.push_back(std::move(runner.motion));
  }
  std::stable_sort(raced.dropped.begin(), raced.dropped.end(), [](const Continuation& a, const Continuation& b) {
    return a.solution().report.objective < b.solution().report.objective;
  });
  return raced;
}

}  // namespace fjr
