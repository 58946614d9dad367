#include "planner/search/findings.h"

#include <utility>

namespace fjr {
namespace {

// Returns the problems to optimise. Their objective is divided by its size, because the optimiser's tolerances and
// regularisation are meant for objectives of order 1 to 100, while weights may be of any size.
//
// A fastest motion may take any time, and its duration is compared with the allowed one afterwards. With a bound just
// above the minimum, a problem with smoothed friction, whose minimum is some per cent longer, would have no solution.
std::vector<std::shared_ptr<const Problem>> alternatives_of(const Problem& asked, double scale) {
  Problem scaled = asked;
  if (only_time(asked.weights)) scaled.duration.max = kLongestDuration;
  for (const TermInfo& term : Terms::infos) scaled.weights.*term.weight /= scale;
  std::vector<std::shared_ptr<const Problem>> all{std::make_shared<const Problem>(scaled)};
  for (const Goal& goal : asked.other_goals) {
    Problem other = scaled;
    other.goal = goal;
    all.push_back(std::make_shared<const Problem>(std::move(other)));
  }
  return all;
}

}  // namespace

Findings::Findings(const Problem& request, const FollowSettings& settings)
    : asked(request),
      scale(objective_scale(request.weights)),
      alternatives(alternatives_of(request, scale)),
      start_iterations(settings.iterations) {}

bool Findings::keep(const Continuation& c, PublishResult published) {
  if (!published.failure.empty()) failure = published.failure;
  if (!published.last) return false;
  const bool certifies = published.certified();
  if (published.last->too_long) {
    note_fastest(c, certifies);
    return false;
  }
  if (!certified() || (certifies && published.last->objective < best->objective)) best = std::move(published.last);
  return certifies;
}

void Findings::keep(Publication plan) {
  if (!certified() || plan.objective < best->objective) best = std::move(plan);
}

void Findings::note_fastest(const Continuation& c, bool certifies) {
  const bool same = fastest && fastest->alternative == c.problem() && fastest->motion.label() == c.label();
  if (fastest && !same && fastest->duration() <= c.solution().motion.duration()) return;
  fastest = Fastest{c, certifies, c.problem()};
}

}  // namespace fjr
