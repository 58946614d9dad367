#include "planner/search/explain/candidates.h"

#include <algorithm>

#include "planner/analysis/analysis.h"
#include "planner/ocp/margins.h"
#include "planner/problem/relaxable.h"
#include "planner/problem/statics.h"
#include "planner/search/slack.h"

namespace fjr {
namespace {

void keep_heaviest(std::vector<Candidate>& candidates, std::size_t most) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.weight > b.weight; });
  if (candidates.size() > most) candidates.resize(most);
}

// The largest excess as a fraction of the limit's size, and when that is.
Candidate worst_excess_of(const Problem& problem, const Relaxable& what, const Collocated& solution) {
  const auto excess = excesses(problem, solution.setup.mesh, solution.motion);
  const PerLimit scales = limit_scales(problem);
  Candidate worst{what, {}, 0};
  for (const std::size_t i : what.indices) {
    for (std::size_t k = 0; k < excess.size(); ++k) {
      if (!(excess[k][i] / scales[i] > worst.weight)) continue;
      worst.weight = excess[k][i] / scales[i];
      worst.time = solution.motion.intervals[k].start;
    }
  }
  return worst;
}

// Returns by how much the limit is below what carrying the arm slowly takes, as a fraction of the limit. Of limits that
// are exceeded alike, those too small for carrying are in the way, and not those that swinging exceeds.
double short_of_carrying(const Problem& problem, const Relaxable& what) {
  if (what.joint == 0 || what.quantity == nullptr) return 0;
  const Limits needed = carrying(problem).needed;
  return std::max(0.0, what.quantity->in(needed, static_cast<std::size_t>(what.joint - 1)) / what.from - 1);
}

}  // namespace

std::optional<double> worst_moment(const Problem& problem, const Relaxable& what, const Collocated& solution) {
  return worst_excess_of(problem, what, solution).time;
}

std::vector<Candidate> active_in(const Continuation& fastest, const ExplanationSettings& settings) {
  const Analysis analysis = analyse(*fastest.problem(), fastest.solution(), 1);
  std::vector<Candidate> candidates;
  for (const Relaxable& what : relaxables(*fastest.problem())) {
    Candidate candidate{what, {}, 0};
    double longest = 0;
    for (const ShadowPrice& limit : analysis.sensitivity.limits) {
      const bool same = std::count(what.indices.begin(), what.indices.end(), limit.index) > 0;
      if (!same || limit.price <= 0) continue;
      candidate.weight += limit.price * what.size() / fastest.problem()->weights.time;
      for (const auto& stretch : limit.active) {
        if (stretch.end - stretch.begin <= longest) continue;
        longest = stretch.end - stretch.begin;
        candidate.time = (stretch.begin + stretch.end) / 2;
      }
    }
    if (candidate.weight > 0) candidates.push_back(candidate);
  }
  keep_heaviest(candidates, settings.candidates);
  return candidates;
}

std::vector<Candidate> candidates(const Problem& problem, const Continuation* everything,
                                  const ExplanationSettings& settings) {
  std::vector<Candidate> found, all;
  const bool time_to_carry =
      everything != nullptr && problem.duration.max > settings.time_to_carry * everything->solution().motion.duration();
  for (const Relaxable& what : relaxables(problem)) {
    if (what.kind == RelaxableKind::kVelocity) {
      all.push_back({what, {}, 0});
    } else if (everything != nullptr) {
      Candidate candidate = worst_excess_of(problem, what, everything->solution());
      const double lacking = short_of_carrying(problem, what);
      const bool enough = lacking > 0 && time_to_carry;  // then the arm need not swing at all
      if (!enough && candidate.weight <= settings.in_the_way * everything->solution().slack) continue;
      candidate.weight = enough ? kNoLimit : candidate.weight + lacking;
      candidate.time.reset();  // that was of another motion
      found.push_back(candidate);
    }
  }
  keep_heaviest(found, settings.candidates);
  all.insert(all.end(), found.begin(), found.end());
  return all;
}

}  // namespace fjr
