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

struct Runner {
  Continuation motion;
  bool counts = true;   // its work was allowed
  bool goes_on = true;  // its last step succeeded
  bool dropped = false;

  double objective() const { return motion.solution().report.objective; }
  bool running() const { return counts && goes_on && !dropped; }
};

// Each motion is compared only with those that were found before it: then additional starts never change which of the
// earlier motions are followed.
void drop_losers(std::vector<Runner>& runners, StepObjectives& reached, const RaceSettings& settings) {
  for (Runner& runner : runners) {
    if (!runner.running()) continue;
    const double width = runner.motion.solution().setup.smoothing.friction_width;
    std::vector<double>& before = reached[width];
    runner.dropped =
        !worth_following(runner.objective(), width, before, sees_friction(runner.motion.problem()->weights), settings);
    before.push_back(runner.objective());
  }
}

// Calls `step` for all runners for which `which` holds, in parallel.
template <class Which, class Step>
void all_do(std::vector<Runner>& runners, Session& session, const Which& which, const Step& step) {
  std::vector<Runner*> at_work;
  for (Runner& runner : runners) {
    if (which(runner)) at_work.push_back(&runner);
  }
  const std::vector<bool> counts = session.do_all(at_work.size(), [&](std::size_t i, Session& own) {
    at_work[i]->motion.go_on_in(own);
    at_work[i]->goes_on = step(at_work[i]->motion);
  });
  for (std::size_t i = 0; i < at_work.size(); ++i) {
    at_work[i]->counts = counts[i];
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
  const auto running = [](const Runner& runner) { return runner.running(); };
  // Where the objective depends on friction, motions with the same objective on refined first meshes lead to the same
  // minimum: all but the first of them are dropped here.
  if (!runners.empty() && sees_friction(runners.front().motion.problem()->weights))
    drop_losers(runners, reached, session.settings().race);
  while (std::any_of(runners.begin(), runners.end(), running)) {
    all_do(runners, session, running, [](Continuation& motion) { return motion.take_step(); });
    drop_losers(runners, reached, session.settings().race);
  }
  const auto at_the_end = [](const Runner& runner) { return runner.counts && !runner.dropped; };
  all_do(runners, session, at_the_end, [](Continuation& motion) { return motion.settle(); });
  Raced raced;
  for (Runner& runner : runners) {
    if (at_the_end(runner) && runner.goes_on) raced.arrived.push_back(std::move(runner.motion));
    if (runner.counts && runner.dropped) raced.dropped.push_back(std::move(runner.motion));
  }
  std::stable_sort(raced.dropped.begin(), raced.dropped.end(), [](const Continuation& a, const Continuation& b) {
    return a.solution().report.objective < b.solution().report.objective;
  });
  return raced;
}

}  // namespace fjr
