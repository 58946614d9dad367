#include "planner/search/motions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "planner/search/acceleration_penalty.h"
#include "planner/search/detours.h"
#include "planner/search/fallbacks.h"
#include "planner/search/fastest.h"
#include "planner/search/follow.h"
#include "planner/search/out_of_reach.h"
#include "planner/search/starts.h"
#include "planner/trajectory/motion.h"

namespace fjr {
namespace {

using Alternative = std::shared_ptr<const Problem>;

// Returns a guess near the best motion so far. Minima lie side by side: from there others are found, in half the
// iterations.
std::optional<Guess> beside_the_best(const Alternative& alternative, double away, std::uint64_t seed,
                                     const Findings& found) {
  const CoarseMotion* best = nullptr;
  for (const CoarseMotion& c : found.candidates) {
    if (c.problem != alternative) continue;
    if (best == nullptr || c.coarse.objective < best->coarse.objective) best = &c;
  }
  if (best == nullptr) return std::nullopt;
  return displaced_guess(guess_of(best->motion, best->durations), away, seed);
}

// Returns the guess of start i, or one near the best motion so far where that is to take its place.
Guess guess_of_start(const Alternative& alternative, const Starts& starts, std::size_t i, double away,
                     const Findings& found) {
  if (starts.guesses[i].near_the_best) {
    if (auto near = beside_the_best(alternative, away, found.asked.seed * 1000 + i, found)) return std::move(*near);
  }
  return starts.guesses[i].guess;
}

// Returns whether the limits that are larger than the asked ones are so by less.
bool less_relaxed(const Limits& limits, const Limits& others, const Limits& asked) {
  const auto factor = [&](const Limits& of) {
    double largest = 1;
    for (const LimitName& name : kLimitNames) largest = std::max(largest, name.in(of) / name.in(asked));
    return largest;  // where neither is limited the quotient is not a number, which max() leaves out
  };
  return factor(limits) < factor(others);
}

void try_swinging(const Alternative& alternative, Findings& found, Session& session) {
  if (!found.candidates.empty() || session.interrupted() || can_be_carried(*alternative)) return;
  SwungUp swung = swing_up(alternative, found.asked.duration.max, session);
  if (swung.motion) follow(std::move(*swung.motion), found, session);
  if (!swung.reached) return;
  found.swing_was_cut = session.interrupted();
  if (found.swing_up && !less_relaxed(*swung.reached, found.swing_up->limits, found.asked.limits)) return;
  found.swing_up = SwingUpLimits{alternative, *swung.reached};
}

// If every alternative is out of reach, the search ends. The fastest motion is still tried where the duration may be
// the reason.
void ask_whether_out_of_reach(const std::vector<Alternative>& open, Findings& found, Session& session) {
  if (!found.candidates.empty()) return;
  std::vector<OutOfReach> why;
  for (const Alternative& alternative : open) {
    const auto what = out_of_reach(*alternative, session);
    if (!what) return;
    why.push_back(*what);
  }
  if (why.empty()) return;
  found.out_of_reach = why.front();
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (why[i] == OutOfReach::kAllLimits) try_from_fastest(open[i], found, session);
  }
  if (!found.candidates.empty()) found.out_of_reach.reset();
}

bool all_seem_too_short(const std::vector<Alternative>& open, Findings& found, Session& session) {
  return std::all_of(open.begin(), open.end(), [&](const Alternative& alternative) {
    return !only_time(alternative->weights) && seems_too_short(alternative, found, session);
  });
}

// Returns whether all of them allow less than a fraction of the usual duration. That is one between rests, and says
// nothing of an arm that moves already.
bool have_little_time(const std::vector<Alternative>& open, double fraction) {
  return std::all_of(open.begin(), open.end(), [=](const Alternative& alternative) {
    const bool between_rests = alternative->start_at_rest && alternative->goal.at_rest;
    return between_rests && alternative->duration.max < fraction * usual_duration(*alternative);
  });
}

// An alternative and the results of its starts.
struct Turn {
  Alternative alternative;
  Starts starts;
  std::vector<std::size_t> failed{};  // numbers of starts without solution
  bool led_somewhere = false;
};

// Starts that are tried at the same time.
struct Wave {
  std::vector<Turn*> turns;          // the turn to which each start belongs
  std::vector<std::size_t> numbers;  // of the starts in their turns
  std::vector<Start> starts;

  void add(Turn& turn, std::size_t number, Start start) {
    turns.push_back(&turn);
    numbers.push_back(number);
    starts.push_back(std::move(start));
  }
};

// Solves the starts of a wave. If one ends at its iteration limit, its turn goes on with a penalty on accelerations,
// where that applies (with_acceleration_penalty()).
void try_wave(Wave& wave, Findings& found, Session& session) {
  const AccelerationPenaltySettings& settings = session.settings().acceleration_penalty;
  const std::vector<TriedStart> tried = try_starts_of_many(wave.starts, found, session);
  for (std::size_t i = 0; i < tried.size(); ++i) {
    Turn& turn = *wave.turns[i];
    TriedStart outcome = tried[i];
    const Alternative penalised =
        outcome == TriedStart::kOutOfIterations ? with_acceleration_penalty(*turn.alternative, settings) : nullptr;
    if (penalised) refine_waiting(found, session);
    if (penalised && !session.interrupted()) {
      ++session.fallbacks().calmed;
      turn.alternative = penalised;
      outcome = try_starts({{penalised, wave.starts[i].guess, wave.starts[i].label + ", with acceleration penalty"}},
                           found, session)[0];
    }
    if (outcome == TriedStart::kSomewhere) {
      turn.led_somewhere = true;
    } else {
      const std::size_t number = wave.numbers[i];
      const bool again = std::count(turn.failed.begin(), turn.failed.end(), number) > 0;
      if (!again) turn.failed.push_back(number);
    }
  }
  session.tell_starts(found.starts, found.starts_planned);
  wave = {};
}

// What is tried beside the starts while none has led anywhere, and before which of them: the fastest motion and
// swinging, and whether the request is out of reach.
class BesideStarts {
 public:
  BesideStarts(const std::vector<Alternative>& open, IfNone if_none, Findings& found, Session& session)
      : open_(open), if_none_(if_none), found_(found), session_(session), order_(session.settings().order) {
    if (have_little_time(open, order_.little_time)) before_sketching_ = 0;
    const OutOfReachSettings& reach = session.settings().out_of_reach;
    if (std::any_of(open.begin(), open.end(), [&](const Alternative& alternative) {
          return asks_for_more_speed_than_motors_have(*alternative, reach);
        })) {
      before_asking_ = 0;
    }
  }

  // Tries what is due before start i. Returns whether the search ends with it.
  bool end_search_before(std::size_t i) {
    if (i == before_sketching_ && are_needed() && all_seem_too_short(open_, found_, session_) && time_is_too_short())
      return true;
    if (i == before_asking_ && are_needed() && is_out_of_reach()) return true;
    return i == order_.before_fastest && are_needed() && time_is_too_short();
  }

 private:
  bool are_needed() const { return if_none_ == IfNone::kFallBack && found_.candidates.empty(); }

  // Looks for the fastest motions, unless it did so before. Returns whether they take longer than is allowed.
  bool time_is_too_short() {
    if (!std::exchange(fastest_was_tried_, true)) {
      for (const Alternative& alternative : open_) try_from_fastest(alternative, found_, session_);
    }
    return found_.too_short();
  }

  // Tries swinging, and asks whether every alternative is out of reach.
  bool is_out_of_reach() {
    for (const Alternative& alternative : open_) try_swinging(alternative, found_, session_);
    ask_whether_out_of_reach(open_, found_, session_);
    return found_.out_of_reach.has_value();
  }

  const std::vector<Alternative>& open_;
  const IfNone if_none_;
  Findings& found_;
  Session& session_;
  const StartOrderSettings& order_;
  std::size_t before_sketching_ = order_.before_sketching_fastest, before_asking_ = order_.before_swinging;
  bool fastest_was_tried_ = false;
};

// Returns whether start i of an alternative is tried. asked: as in take_turns().
bool wants_start(const Turn& turn, std::size_t i, int asked, const StartOrderSettings& order, const Findings& found) {
  if (i >= turn.starts.guesses.size()) return false;
  if (found.candidates.empty()) return asked != 0 || i < turn.starts.enough;
  const bool given_up = !turn.led_somewhere && static_cast<int>(turn.failed.size()) >= order.given_up;
  return i < turn.starts.always && !given_up;
}

// Tries starts of a turn that led nowhere again, from their other guesses along the same paths, if they have any.
void try_again(Turn& turn, Findings& found, Session& session) {
  Wave wave;
  for (const std::size_t i : turn.failed) {
    const std::optional<Guess>& other = turn.starts.guesses[i].along_path_again;
    if (other) wave.add(turn, i, {turn.alternative, *other, fmt::format("start {} again", i + 1)});
  }
  if (wave.starts.empty() || session.interrupted()) return;
  found.starts_planned += static_cast<int>(wave.starts.size());
  try_wave(wave, found, session);
}

// Solves the starts of the alternatives in turn, because the results of one tell how long the others are worth trying.
// asked: number of starts, whatever their results; 0: as many as are worth trying.
void take_turns(const std::vector<Alternative>& open, int asked, IfNone if_none, Findings& found, Session& session) {
  const StartOrderSettings& order = session.settings().order;
  const int count = starts_to_try(found.asked, asked, session.settings().starts);
  std::vector<Turn> turns;
  std::size_t most = 0;
  for (const Alternative& alternative : open) {
    turns.push_back({alternative, starts_of(*alternative, count, session.settings().starts)});
    most = std::max(most, turns.back().starts.guesses.size());
    found.starts_planned += static_cast<int>(turns.back().starts.always);
  }
  session.tell_starts(found.starts, found.starts_planned);
  Wave wave;
  BesideStarts beside(open, if_none, found, session);
  for (std::size_t i = 0; i < most; ++i) {
    if (beside.end_search_before(i)) return;
    for (Turn& turn : turns) {
      if (session.interrupted()) return;
      if (i > 0 && i == count_along_paths(turn.starts)) {
        if (!wave.starts.empty()) try_wave(wave, found, session);
        try_again(turn, found, session);
      }
      if (!wants_start(turn, i, asked, order, found)) continue;
      if (i >= turn.starts.always) ++session.fallbacks().displaced_start;
      const std::string label = fmt::format("start {} of {}", i + 1, std::max(i + 1, turn.starts.always));
      wave.add(turn, i,
               {turn.alternative, guess_of_start(turn.alternative, turn.starts, i, order.near_by, found), label,
                turn.starts.guesses[i].by_interior_point});
      if (wave.starts.size() >= (found.candidates.empty() ? 1 : order.at_a_time)) try_wave(wave, found, session);
    }
  }
  try_wave(wave, found, session);
}

}  // namespace

void find_motions(int count, IfNone if_none, Findings& found, Session& session) {
  const Timed timed(session, "starts");
  std::vector<Alternative> open;
  for (const Alternative& alternative : found.alternatives) {
    if (!no_path(*alternative)) open.push_back(alternative);
  }
  take_turns(open, count, if_none, found, session);
  refine_waiting(found, session);
  if (!found.candidates.empty() || found.too_short() || found.out_of_reach || if_none == IfNone::kGiveUp) return;
  session.allow_more(session.settings().budget.fallbacks);
  for (const Alternative& alternative : open) {
    if (!found.candidates.empty() || session.interrupted() || found.too_short()) return;
    if (auto motion = fall_back(alternative, session)) follow(std::move(*motion), found, session);
  }
}

}  // namespace fjr
