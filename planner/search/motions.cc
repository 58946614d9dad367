#include "planner/search/motions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "planner/search/detours.h"
#include "planner/search/fallbacks.h"
#include "planner/search/fastest.h"
#include "planner/search/follow.h"
#include "planner/search/starts.h"

namespace fjr {
namespace {

using Alternative = std::shared_ptr<const Problem>;

constexpr double kNearBy = 0.3;  // [rad] that the best motion so far is displaced by: minima lie side by side
constexpr int kGivenUp = 2;      // failures of an alternative's first starts, while another led somewhere
constexpr std::size_t kBeforeSwinging = 1;  // starts that led nowhere before it is asked whether it has to swing
constexpr std::size_t kBeforeHurrying = 2;  // and before it is asked whether there is time

// Minima lie side by side: from a place near the best motion so far others are met, and in half the iterations.
std::optional<Guess> beside_the_best(const Alternative& alternative, std::uint64_t seed, const Findings& found) {
  const CoarseMotion* best = nullptr;
  for (const CoarseMotion& c : found.candidates) {
    if (c.problem != alternative) continue;
    if (best == nullptr || c.coarse.objective < best->coarse.objective) best = &c;
  }
  if (best == nullptr) return std::nullopt;
  return displaced_guess(guess_from(best->motion, best->durations, best->motion.duration()), kNearBy, seed);
}

// Start i, by its guess or beside the best motion so far.
Guess guess_of_start(const Alternative& alternative, const Starts& starts, std::size_t i, const Findings& found) {
  if (i >= starts.guided && (i - starts.guided) % 2 == 1) {
    if (auto near = beside_the_best(alternative, found.asked.seed * 1000 + i, found)) return std::move(*near);
  }
  return starts.guesses[i];
}

void try_swinging(const Alternative& alternative, Findings& found, Session& session) {
  if (!found.candidates.empty() || session.interrupted() || can_be_carried(*alternative)) return;
  SwungUp swung = swing_up(alternative, found.asked.duration.max, session);
  if (swung.motion) follow(std::move(*swung.motion), found, session);
  if (swung.reached) found.carried_with = swung.reached;
}

// The alternatives take turns: what one of them came to tells how long the others are worth trying. asked: as many
// starts, whatever they come to; 0: as many as are worth trying.
void try_starts(const std::vector<Alternative>& open, int asked, Findings& found, Session& session) {
  const int count = asked > 0 ? asked : starts_worth_trying(found.asked.weights);
  struct Turn {
    Alternative alternative;
    Starts starts;
    int failed = 0;  // of the first starts
    bool led_somewhere = false;
  };
  std::vector<Turn> turns;
  std::size_t most = 0;
  for (const Alternative& alternative : open) {
    turns.push_back({alternative, starts_of(*alternative, count)});
    most = std::max(most, turns.back().starts.guesses.size());
    found.starts_planned += static_cast<int>(turns.back().starts.always);
  }
  for (std::size_t i = 0; i < most; ++i) {
    if (i == kBeforeSwinging && found.candidates.empty()) {
      for (const Alternative& alternative : open) try_swinging(alternative, found, session);
    }
    if (i == kBeforeHurrying && found.candidates.empty()) {
      for (const Alternative& alternative : open) try_from_fastest(alternative, found, session);
      if (found.too_short()) return;
    }
    for (Turn& turn : turns) {
      if (session.interrupted()) break;
      if (i >= turn.starts.guesses.size()) continue;
      const bool needed = i < turn.starts.always, given_up = !turn.led_somewhere && turn.failed >= kGivenUp;
      if (!found.candidates.empty() && (!needed || given_up)) continue;
      if (found.candidates.empty() && asked == 0 && i >= turn.starts.enough) continue;
      if (!needed) ++session.fallbacks().displaced_start;
      const std::string label = fmt::format("start {} of {}", i + 1, std::max(i + 1, turn.starts.always));
      const Guess guess = guess_of_start(turn.alternative, turn.starts, i, found);
      if (try_start(turn.alternative, guess, label, found, session)) {
        turn.led_somewhere = true;
      } else {
        ++turn.failed;
      }
    }
  }
}

}  // namespace

void find_motions(int count, Findings& found, Session& session) {
  const Timed timed(session, "starts");
  std::vector<Alternative> open;
  for (const Alternative& alternative : found.alternatives) {
    if (no_path(*alternative).sentence.empty()) open.push_back(alternative);
  }
  try_starts(open, count, found, session);
  for (const Alternative& alternative : open) {
    if (!found.candidates.empty() || session.interrupted() || found.too_short()) break;
    if (auto motion = fall_back(alternative, session)) follow(std::move(*motion), found, session);
  }
}

}  // namespace fjr
