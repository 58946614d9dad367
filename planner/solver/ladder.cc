#include "planner/solver/ladder.h"

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
constexpr double kCoarser = 0.5, kFiner = 2;            // times the usual number of intervals
constexpr double kRelaxed[] = {0.5, 3};                 // shares by which limits are relaxed at first
constexpr double kTightening[] = {0.4, 0.15, 0.04, 0};  // of that share, step by step

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

// The relaxed problems only have to live as long as their solution is the start of the next.
std::optional<Continuation> tighten(const Problem& problem, const SolveTools& tools, const Guess& guess, double share) {
  const Problem loose = relaxed(problem, share);
  const auto first = attempt(loose, tools, fmt::format("limits relaxed by {:g} %", 100 * share), guess);
  if (!first) return std::nullopt;
  Motion motion = first->solution().motion;
  std::vector<double> durations = first->solution().durations;
  for (const double step : kTightening) {
    const Problem tighter = relaxed(problem, step * share);
    const std::string label = step > 0 ? fmt::format("limits relaxed by {:g} %", 100 * step * share) : "elastic";
    const auto next =
        attempt(step > 0 ? tighter : problem, tools, label, guess_from(motion, durations, motion.duration()));
    if (!next || step == 0) return next;
    motion = next->solution().motion;
    durations = next->solution().durations;
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
