#include <algorithm>
#include <vector>

#include "planner/problem/relaxable.h"
#include "planner/search/explain/reasons.h"

namespace fjr {
namespace {

// Widens one constraint until there is a path and a motion. The width is taken from the grid, because a problem with
// a slack can pass through obstacles between the collocation points. More than what is missing [m] is needed between
// two obstacles, because half of what one gives up is lost to the other one, and where the optimiser finds no motion
// along a path that is barely open.
void widen(Explanation& e, const Relaxable& what, double missing) {
  if (missing == 0) return;
  for (const double more : e.settings().widths) {
    const double amount = more * e.settings().barred_margin * missing;
    if (amount >= what.most || e.search.over()) return;
    e.anything_tried = true;
    const Problem wider = what.relaxed(e.problem, amount);
    if (no_path(wider)) continue;
    if (!e.search.solve(wider, what.name, e.search.guesses(wider))) continue;
    e.result.relaxations.push_back(relaxation_of(what, what.value(amount)));
    return;
  }
}

}  // namespace

void explain_barred(const NoPath& barred, Explanation& e) {
  e.result.sentence = barred.sentence;
  for (const Relaxable& what : relaxables(e.problem)) {
    const auto& bars = barred.constraints;
    if (what.constraint == nullptr || std::count(bars.begin(), bars.end(), what.number) == 0) continue;
    if (e.result.limit.empty()) e.result.limit = what.name;
    widen(e, what, barred.missing);
  }
}

}  // namespace fjr
