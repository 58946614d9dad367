#include "planner/search/explain/explain.h"

#include <fmt/format.h>

#include <cmath>

#include "planner/problem/relaxable.h"
#include "planner/search/detours.h"
#include "planner/search/explain/explanation.h"
#include "planner/search/explain/reasons.h"

namespace fjr {
namespace {

void add_relaxations_to_sentence(Explanation& e) {
  bool any = false;
  for (const Relaxation& r : e.result.relaxations) {
    if (r.kind == RelaxableKind::kDuration) continue;
    any = true;
    e.result.sentence += "; " + sentence_of(r);
  }
  if (!any && e.anything_tried && !e.search.over())
    e.result.sentence += fmt::format("; no {}change of a single limit was found to be enough",
                                     e.result.relaxations.empty() ? "" : "other ");
}

}  // namespace

double Explanation::rounded_up(double duration) const {
  return std::ceil(1e4 * (1 + settings().duration_margin) * duration) / 1e4;
}

WhyNot explain(const Problem& problem, const Known& known, Session& session) {
  Explanation e(problem, known, session);
  if (const auto barred = no_path(problem)) {
    explain_barred(*barred, e);
  } else if (e.is_too_short()) {
    explain_duration(e);
  } else {
    if (known.fastest != nullptr) e.result.shortest_duration = e.rounded_up(e.shortest());
    if (known.out_of_reach != OutOfReach::kVelocity) explain_via_times(e);
    const bool told = e.start || !e.result.sentence.empty();
    if (!told && (known.fastest == nullptr || any_timed(problem))) explain_limits(e);
  }
  if (e.start) return {{}, e.start};
  if (e.result.sentence.empty()) return {};
  add_relaxations_to_sentence(e);
  return {e.result, {}};
}

}  // namespace fjr
