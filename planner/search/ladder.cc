#include "planner/search/ladder.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "planner/problem/relaxable.h"

namespace fjr {
namespace {

constexpr int kPatience = 300;       // iterations of one attempt
constexpr int kMorePatience = 1200;  // what has to swing up first took up to 630
constexpr double kMoreEffort = 10;   // times the usual trace of it
constexpr std::size_t kPatientStarts = 2;
constexpr double kCoarser = 0.5, kFiner = 2;  // times the usual number of intervals
constexpr double kRelaxed[] = {0.5, 3};       // shares by which limits are relaxed at first
constexpr double kTightening = 0.4;           // of that share, step by step
constexpr double kNearlyTight = 0.1;          // from there the limits themselves are tried
constexpr int kHalvings = 4;                  // of steps that could not be taken

std::optional<Continuation> begun(Continuation c, const SolveTools& tools, const Guess& guess, int patience) {
  const bool solved = !tools.interrupted() && c.begin(guess, patience);
  tools.book(c);
  if (!solved) return std::nullopt;
  return c;
}

std::optional<Continuation> attempt(const Problem& problem, const SolveTools& tools, const std::string& label,
                                    const Guess& guess, double mesh_factor = 1) {
  Continuation c = tools.continuation(problem, label);
  c.mesh_factor = mesh_factor;
  return begun(std::move(c), tools, guess, kPatience);
}

std::optional<Continuation> attempt_patiently(const Problem& problem, const SolveTools& tools, const Guess& guess) {
  Continuation c = tools.continuation(problem, "with patience");
  c.trace_factor = kMoreEffort;
  return begun(std::move(c), tools, guess, kMorePatience);
}

// A step that cannot be taken is halved. The relaxed problems only have to live as long as their solution is the start
// of the next.
std::optional<Continuation> tighten(const Problem& problem, const SolveTools& tools, Guess guess, double share) {
  double reached = kNoLimit, target = share;
  for (int failures = 0; failures <= kHalvings;) {
    const Problem looser = relaxed(problem, target);
    const std::string label = target > 0 ? fmt::format("limits relaxed by {:.3g} %", 100 * target) : "elastic";
    const auto next = attempt(target > 0 ? looser : problem, tools, label, guess);
    if (next && target == 0) return next;
    if (!next && target == share) return std::nullopt;
    if (next) {
      const Collocated& solution = next->solution();
      guess = guess_from(solution.motion, solution.durations, solution.motion.duration());
      reached = target;
      target = reached > kNearlyTight ? kTightening * reached : 0;
    } else {
      ++failures;
      target = (reached + target) / 2;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<Continuation> climb(const Problem& problem, const SolveTools& tools, Fallbacks& tried) {
  const std::vector<Guess> guesses = tools.guesses(problem);
  for (std::size_t i = 0; i < std::min(kPatientStarts, guesses.size()) && !tools.interrupted(); ++i) {
    ++tried.patience;
    if (auto found = attempt_patiently(problem, tools, guesses[i])) return found;
  }
  const std::pair<double, int*> meshes[] = {{kCoarser, &tried.coarser_mesh}, {kFiner, &tried.finer_mesh}};
  for (const auto& [factor, count] : meshes) {
    if (tools.interrupted()) return std::nullopt;
    ++*count;
    if (auto found = attempt(problem, tools, factor < 1 ? "coarser mesh" : "finer mesh", guesses.front(), factor)) {
      return found;
    }
  }
  for (const double share : kRelaxed) {
    if (tools.interrupted()) return std::nullopt;
    ++tried.elastic;
    if (auto found = tighten(problem, tools, guesses.front(), share)) return found;
  }
  return std::nullopt;
}

}  // namespace fjr
