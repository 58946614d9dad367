// An explanation while it is made. Its parts (reasons.h) share it.
#pragma once

#include <optional>

#include "planner/problem/problem.h"
#include "planner/search/explain/explain.h"
#include "planner/search/explain/relaxation.h"
#include "planner/search/guesses.h"
#include "planner/search/search.h"
#include "planner/search/session.h"

namespace fjr {

struct Explanation {
  Explanation(const Problem& request, const Known& found, Session& of)
      : problem(request), known(found), session(of), search(of) {}

  // Returns the shortest duration [s]; known.fastest must not be null.
  double shortest() const { return known.fastest->solution().motion.duration(); }

  // Returns whether even the fastest motion takes longer than is allowed.
  bool is_too_short() const { return known.fastest != nullptr && shortest() > problem.duration.max; }

  const ExplanationSettings& settings() const { return session.settings().explanation; }
  const SlackSettings& slack_settings() const { return session.settings().slack; }

  // Returns a shortest duration [s] as it is reported: rounded up and with a little to spare, so that a request for it
  // has a plan.
  double rounded_up(double duration) const;

  const Problem& problem;
  const Known& known;
  Session& session;
  Search search;
  Infeasibility result{};
  bool anything_tried = false;   // whether relaxing anything was tried
  std::optional<Guess> start{};  // of a motion for the request, which turned out to be possible
};

}  // namespace fjr
