#include "planner/search/robust.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/uncertainty.h"
#include "planner/certificate/robust/robustness.h"

namespace fjr {
namespace {

TaskOfMotion task_of(const Publication& p) {
  return TaskOfMotion::of(p.problem->robot, p.problem->task, segment_ends(p.solution.durations));
}

// Returns the time [s] at a place of the motion; places count segments, with fractions.
double time_at(const std::vector<double>& ends, double place) {
  const auto segment = std::min(static_cast<std::size_t>(place), ends.size() - 1);
  const double begin = segment == 0 ? 0 : ends[segment - 1];
  return begin + (place - static_cast<double>(segment)) * (ends[segment] - begin);
}

// Returns the largest half width of a tube between two times and one sample beyond them, because switching times move
// with the next motion.
double widest_between(const std::vector<double>& tube, const std::vector<double>& times, double from, double to) {
  const auto index = [&](double time) { return std::lower_bound(times.begin(), times.end(), time) - times.begin(); };
  const auto last = static_cast<std::ptrdiff_t>(tube.size()) - 1;
  const auto begin = std::clamp<std::ptrdiff_t>(index(from) - 1, 0, last), end = std::min(index(to) + 1, last);
  return *std::max_element(tube.begin() + begin, tube.begin() + end + 1);
}

// Returns what a margin takes from the limit of plans. That limit may be less than the one that holds with feedback;
// the difference covers part of the margin.
double taken(const Problem& asked, std::size_t limit, const Robustness::Margin& m, double margin) {
  const double left_for_feedback = m.limit - kLimitNames[limit].in(asked.limits);
  return std::max(0.0, margin - left_for_feedback);
}

// Returns the reserve so far, widened to the tubes of this motion.
Reserve widened(const Reserve& before, const Problem& asked, const Publication& p, const Robustness& r,
                const RobustSettings& settings) {
  const std::vector<double> ends = segment_ends(p.solution.durations);
  const auto segments = static_cast<double>(ends.size());
  const std::vector<TaskRow> rows = task_rows(asked.robot, asked.task, 0);
  const auto pieces = static_cast<double>(settings.pieces);
  Reserve reserve;
  for (std::size_t k = 0; k < settings.pieces; ++k) {
    const double from = segments * static_cast<double>(k) / pieces, to = segments * static_cast<double>(k + 1) / pieces;
    std::vector<double> margins(kLimits + r.task.size(), 0.0);
    const auto of = [&](const Robustness::Margin& m) {
      return settings.wider * widest_between(m.tube, r.times, time_at(ends, from), time_at(ends, to));
    };
    for (const Robustness::Margin& m : r.limits) {
      margins[m.index] = taken(asked, m.index, m, of(m));
    }
    for (std::size_t row = 0; row < r.task.size(); ++row) {
      // A row along a line gets no margin of its own: where it lacks one, the row across the same line gets a wider
      // one.
      if (rows[row].across && r.task[row].passed) continue;
      const std::size_t index = kLimits + rows[row].across.value_or(row);
      margins[index] = std::max(margins[index], of(r.task[row]));
    }
    for (std::size_t i = 0; i < margins.size() && !before.margins.empty(); ++i) {
      margins[i] = std::max(margins[i], before.margins[k][i]);
    }
    reserve.places.push_back(to);
    reserve.margins.push_back(std::move(margins));
  }
  return reserve;
}

// Returns the mean of two reserves, for when the wanted one cannot be reached in one step.
Reserve halfway(const Reserve& kept, Reserve wanted) {
  for (std::size_t k = 0; k < wanted.margins.size(); ++k) {
    for (std::size_t i = 0; i < wanted.margins[k].size(); ++i) {
      const double before = kept.margins.empty() ? 0 : kept.margins[k][i];
      wanted.margins[k][i] = 0.5 * (before + wanted.margins[k][i]);
    }
  }
  return wanted;
}

// Returns a certified motion that keeps the problem's reserve, found from one that keeps less; nothing if none is
// found.
std::optional<Publication> with_reserve(const std::shared_ptr<const Problem>& problem, const Collocated& from,
                                        const Problem& asked, Session& session) {
  const auto certified = [&](Continuation& c) -> std::optional<Publication> {
    PublishResult published = publish(c, asked, session);
    if (!published.certified() || published.last->too_long) return std::nullopt;
    return std::move(published.last);
  };
  const std::string label = "with margins for other arms";
  Continuation moved(problem, session, label);
  if (moved.resume(from) == ResumeOutcome::kSolved) {
    if (auto published = certified(moved)) return published;
  }
  // Where a path or a limit is active nearly all the time, margins change the active set, and a warm start with the old
  // multipliers fails. Then the problem is solved from the motion alone.
  Continuation afresh(problem, session, label + ", afresh", {.iteration_factor = session.settings().robust.patience});
  if (session.interrupted() || !afresh.adopt(from, from.motion.duration())) return std::nullopt;
  if (afresh.refine() == Completion::kStopped) return std::nullopt;
  return certified(afresh);
}

// Returns the robot with one parameter known twice as well, as by an independent measurement: what is correlated with
// it is known better, too. Independent errors keep the same numbers to the last digit, so that the same arms are drawn
// but for that parameter.
Parameters known_twice_as_well(const Parameters& robot, const std::string& parameter) {
  constexpr double kLeft = 0.25;  // of its variance
  Uncertainty u = uncertainty_of(robot);
  const auto i = std::find(u.names.begin(), u.names.end(), parameter) - u.names.begin();
  const double variance = u.covariance(i, i);
  const Eigen::VectorXd column = u.covariance.col(i);
  u.covariance -= (1 - kLeft) / variance * column * column.transpose();
  u.covariance(i, i) = kLeft * variance;
  Parameters known = robot;
  known.payload.mass_error = known.payload.inertia_error = 0;  // already in the covariance
  u.payload = known.payload;
  known.uncertainty = std::make_shared<const Uncertainty>(std::move(u));
  return known;
}

void withdraw(Publication& motion) {
  motion.certificate.certified = false;
  motion.certificate.failures.emplace_back("there was no time left to look for margins for other arms");
}

// Replaces a certified motion by one with margins, as far as possible. Its certificate says whether they are enough.
void add_margins(Publication& best, const Problem& asked, Session& session) {
  const double without = best.objective;
  Reserve reserve;
  const auto keep = [&](Reserve wanted) {
    if (session.interrupted()) return false;
    Problem tightened = *best.problem;
    tightened.variation.reserve = std::move(wanted);
    const auto keeping = std::make_shared<const Problem>(std::move(tightened));
    auto published = with_reserve(keeping, best.solution, asked, session);
    if (!published) return false;
    reserve = keeping->variation.reserve;
    best = std::move(*published);
    return true;
  };
  const ForEach for_each = session.side_by_side();
  std::mutex asking;
  const auto stopped = [&] {
    const std::lock_guard lock(asking);
    session.interrupted();  // looks at the clock
    return session.stopped();
  };
  const RobustSettings& settings = session.settings().robust;
  for (int round = 0;; ++round) {
    {
      const Timed timed(session, "robust");
      best.certificate.robustness =
          robustness(asked.robot, asked.limits, task_of(best), best.trajectory, *asked.robust, for_each, stopped);
    }
    Robustness& r = best.certificate.robustness;
    if (!r.evaluated) return withdraw(best);
    r.price = best.objective - without;
    if (r.kept) return;
    if (round < settings.fitting_rounds && std::isfinite(r.link[0])) {
      const Reserve wanted = widened(reserve, asked, best, r, settings);
      if (keep(wanted) || keep(halfway(reserve, wanted))) continue;
    }
    best.certificate.certified = false;
    best.certificate.failures.push_back(r.reason);
    return;
  }
}

}  // namespace

std::optional<Publication> make_robust(const Problem& asked, Findings& found, Session& session) {
  if (!asked.robust || !found.certified()) return std::nullopt;
  found.certified_for_the_robot = true;
  if (session.stopped()) {
    withdraw(*found.best);
    return std::nullopt;
  }
  session.enter(Phase::kMargins);
  const Publication without = *found.best;
  add_margins(*found.best, asked, session);
  return without;
}

std::optional<double> saved_by_half_the_error(const std::string& parameter, const Problem& asked,
                                              const Publication& without, const Publication& best, Session& session) {
  if (session.interrupted()) return std::nullopt;
  Problem known = asked;
  known.robot = known_twice_as_well(asked.robot, parameter);
  Publication again = without;
  add_margins(again, known, session);
  if (!again.certificate.robustness.kept) return std::nullopt;
  return best.objective - again.objective;
}

}  // namespace fjr
