#include "planner/search/fastest.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "planner/search/fallbacks.h"
#include "planner/search/follow.h"
#include "planner/search/race.h"
#include "planner/search/starts.h"

namespace fjr {
namespace {

// The fastest motion of an alternative is looked for from several guesses: first on coarse meshes, of which only the
// shortest motions are refined.
class FastestMotion {
 public:
  FastestMotion(const std::shared_ptr<const Problem>& alternative, double allowed, Findings& found, Session& session)
      : alternative_(alternative),
        fastest_(std::make_shared<const Problem>(fastest_of(*alternative))),
        allowed_(allowed),
        found_(found),
        session_(session),
        start_iterations_(found.start_iterations) {}

  // Returns a motion that takes no more than is allowed, or else the shortest one. The latter is certified if possible,
  // because its duration is reported to the user.
  std::optional<Fastest> find() {
    const StartSettings& settings = session_.settings().starts;
    const Starts starts = starts_of(*fastest_, starts_to_try(*fastest_, 0, settings), settings);
    // The first one, whose result seems_too_short() may have kept, is tried alone: often its motion is short enough,
    // and it tells how many iterations the others are worth. Those beyond the usual ones are tried if nothing was
    // found, as for the request for that motion: of 41 durations that were up to a tenth too short no other minimum was
    // enough.
    const bool fits = (take_sketch() ? refine_up_to(allowed_) : try_starts(starts.guesses, 0, 1)) ||
                      try_starts(starts.guesses, 1, starts.always) || try_again(starts.guesses) ||
                      (!shortest_so_far() && try_starts(starts.guesses, starts.always, starts.guesses.size()));
    if (!fits && shortest_so_far()) refine_up_to(*shortest_so_far());
    if (!shortest_) return std::nullopt;
    const bool certified = shortest_->duration() > allowed_ && certify();  // which may change the motion
    return Fastest{*std::move(shortest_), certified, alternative_};
  }

 private:
  // Returns the duration [s] of the shortest motion, refined or not; nothing if there is none.
  std::optional<double> shortest_so_far() const {
    std::optional<double> shortest;
    if (shortest_) shortest = shortest_->duration();
    for (const Continuation& c : coarse_) shortest = std::min(shortest.value_or(c.duration()), c.duration());
    return shortest;
  }

  static bool is_shorter(const Continuation& a, const Continuation& b) { return a.duration() < b.duration(); }

  // Solves the problem from these guesses, and refines what may come to no more time than is allowed. Returns whether
  // one does.
  bool try_starts(const std::vector<StartGuess>& starts, std::size_t first, std::size_t last) {
    std::vector<Guess> guesses;
    for (std::size_t i = first; i < std::min(last, starts.size()); ++i) guesses.push_back(starts[i].guess);
    for (const std::size_t i : begin(guesses)) failed_.push_back(first + i);
    return refine_up_to(allowed_);
  }

  // Does the same for the starts that led nowhere, from their other guesses along the same paths, if they have any.
  bool try_again(const std::vector<StartGuess>& starts) {
    std::vector<Guess> guesses;
    for (const std::size_t i : failed_) {
      if (starts[i].along_path_again) guesses.push_back(*starts[i].along_path_again);
    }
    begin(guesses);
    return refine_up_to(allowed_);
  }

  // Takes the sketch of this alternative for the result of the first start. Returns whether that was tried.
  bool take_sketch() {
    for (const FastestSketch& sketch : found_.sketches) {
      if (sketch.alternative != alternative_) continue;
      if (sketch.motion) {
        note(*sketch.motion);
      } else {
        failed_.push_back(0);
      }
      return true;
    }
    return false;
  }

  // Notes a motion on a coarse mesh, unless it is known.
  void note(Continuation c) {
    const SolverStage& first = c.stages().front();
    if (any_same(known_, first.objective, session_.settings().continuation.first.same_minimum)) return;
    known_.push_back(first.objective);
    start_iterations_ =
        std::min(start_iterations_, std::max(session_.settings().follow.least_iterations, first.iterations));
    coarse_.push_back(std::move(c));
  }

  // Solves the problem from these guesses on coarse meshes. Later ones may take no more iterations than the quickest
  // before them: none of 234 shortest motions took more. Returns the numbers of those that led nowhere.
  std::vector<std::size_t> begin(const std::vector<Guess>& guesses) {
    std::vector<std::optional<Continuation>> begun(guesses.size());
    std::vector<std::size_t> failed;
    const std::vector<PieceOfWork> pieces = session_.do_all(guesses.size(), [&](std::size_t i, Session& own) {
      Continuation c(fastest_, own, "fastest");
      if (c.begin(guesses[i], start_iterations_, known_) == StartOutcome::kNoSolution) return;
      c.go_on_in(session_);
      begun[i] = std::move(c);
    });
    for (std::size_t i = 0; i < begun.size(); ++i) {
      if (pieces[i] == PieceOfWork::kIgnored) continue;
      if (begun[i]) {
        note(*std::move(begun[i]));
      } else {
        failed.push_back(i);
      }
    }
    return failed;
  }

  // Refines the coarse motions that may come to so much time [s]. Returns whether one takes no more than is allowed.
  bool refine_up_to(double duration) {
    const double most = (1 + session_.settings().follow.within) * duration;
    const auto rest = std::stable_partition(coarse_.begin(), coarse_.end(),
                                            [&](const Continuation& c) { return c.duration() <= most; });
    std::vector<Continuation> promising(std::move_iterator(coarse_.begin()), std::move_iterator(rest));
    coarse_.erase(coarse_.begin(), rest);
    std::stable_sort(promising.begin(), promising.end(), is_shorter);
    for (Continuation& c : race(std::move(promising), reached_, session_).arrived) {
      if (!shortest_ || is_shorter(c, *shortest_)) shortest_ = std::move(c);
    }
    return shortest_ && shortest_->duration() <= allowed_;
  }

  bool certify() {
    const PublishResult published = publish(*shortest_, found_.asked, session_);
    if (!published.failure.empty()) found_.failure = published.failure;
    return published.certified();
  }

  const std::shared_ptr<const Problem>& alternative_;
  std::shared_ptr<const Problem> fastest_;  // the alternative with time as its objective
  double allowed_;                          // [s]
  Findings& found_;
  Session& session_;
  int start_iterations_;              // iterations that a start may take
  std::vector<double> known_;         // minima
  std::vector<std::size_t> failed_;   // numbers of starts that led nowhere
  std::vector<Continuation> coarse_;  // not refined
  StepObjectives reached_;            // objectives after the homotopy steps
  std::optional<Continuation> shortest_;
};

// Returns how the fastest motion to the goal gets to via point i, with the times of those before it kept. Usual guesses
// rest at the points, and what they lead to turns back where a point is to be passed soon after another: 0.374 s were
// told for a point that can be passed at 0.324 s.
std::optional<Guess> on_the_way_to_goal(const Problem& problem, std::size_t i, const std::string& what,
                                        Search& search) {
  Problem fastest = fastest_of(problem);
  for (std::size_t k = 0; k < i; ++k) {
    fastest.via[k].time = problem.via[k].time;
    fastest.duration.min = problem.via[k].time.value_or(fastest.duration.min) + kShortestDuration;
  }
  const auto found = search.sketch(fastest, what, search.guesses(fastest));
  if (!found) return std::nullopt;
  return first_segments_of(guess_of(*found), i + 1);
}

}  // namespace

Problem fastest_of(Problem problem) {
  problem.weights = Weights{};
  problem.weights.time = 1;
  problem.duration = {kShortestDuration, kLongestDuration};
  for (Via& via : problem.via) via.time.reset();
  problem.variation.pause.reset();
  return problem;
}

Problem fastest_to_via(Problem problem, std::size_t i) {
  const Via via = problem.via[i];
  problem.goal = Goal{};
  problem.goal.q = via.q;
  problem.goal.dq = via.dq.value_or(Joints<double>{});
  problem.goal.dq_free = !via.dq;
  problem.goal.at_rest = false;
  problem.other_goals.clear();
  problem.release.reset();
  problem.via.resize(i);
  const double before = i > 0 ? problem.via.back().time.value_or(0) : 0;
  problem.duration = {before + kShortestDuration, kLongestDuration};
  problem.weights = {.time = 1};
  return problem;
}

std::optional<Continuation> sketch_to_via(const Problem& problem, std::size_t i, Search& search) {
  const std::string what = fmt::format("via[{}].time", i);
  const Problem hurry = fastest_to_via(problem, i);
  std::vector<Guess> guesses = search.guesses(hurry);
  if (i > 0) {
    if (auto onward = on_the_way_to_goal(problem, i, what, search)) guesses.push_back(*std::move(onward));
  }
  return search.least_sketch(hurry, what, guesses);
}

bool seems_too_short(const std::shared_ptr<const Problem>& alternative, Findings& found, Session& session) {
  if (!can_be_carried(*alternative)) return false;
  const auto fastest = std::make_shared<const Problem>(fastest_of(*alternative));
  const SearchSettings& settings = session.settings();
  const Guess guess = first_guesses(*fastest, settings.starts).front();
  const double mesh_factor = mesh_factor_of_sketch(*fastest, guess, settings.explanation.solves);
  Continuation sketch(fastest, session, "fastest", {.mesh_factor = mesh_factor});
  const bool led_somewhere = sketch.begin(guess, found.start_iterations) == StartOutcome::kNew;
  const bool too_long = led_somewhere && sketch.duration() > alternative->duration.max;
  if (mesh_factor == 1) {  // otherwise the mesh is too coarse for a start
    FastestSketch& kept = found.sketches.emplace_back(FastestSketch{alternative, {}});
    if (led_somewhere) kept.motion = std::move(sketch);
  }
  return too_long;
}

void try_from_fastest(const std::shared_ptr<const Problem>& alternative, Findings& found, Session& session) {
  const double allowed = alternative->duration.max;
  if (!found.candidates.empty() || session.interrupted()) return;
  const bool was_tried = only_time(alternative->weights) && alternative->duration.min <= kShortestDuration;
  if (was_tried) return;
  ++session.fallbacks().from_fastest;
  const std::optional<Fastest> shortest = FastestMotion(alternative, allowed, found, session).find();
  if (!shortest) return;
  if (!found.fastest || shortest->duration() < found.fastest->duration()) found.fastest = shortest;
  if (shortest->duration() > allowed || any_timed(*alternative)) return;
  const double duration = std::clamp(shortest->duration(), alternative->duration.min, allowed);
  const Collocated& solution = shortest->motion.solution();
  try_starts({{alternative, guess_from(solution.motion, solution.durations, duration), "from the fastest"}}, found,
             session);
  if (found.candidates.empty() && !session.interrupted()) adopt_fastest(found, session);
}

bool has_little_spare_time(const Findings& found, const FastestSettings& settings) {
  return found.fastest && !any_timed(found.asked) && !only_time(found.asked.weights) &&
         found.asked.duration.max < settings.hardly_more * found.fastest->duration();
}

void adopt_fastest(Findings& found, Session& session) {
  Fastest& fastest = *found.fastest;
  Continuation c(fastest.alternative, session, "from the fastest, exact");
  const Completion refined = fastest.motion.refine();
  const Duration& allowed = found.asked.duration;
  if (refined == Completion::kStopped || fastest.duration() > allowed.max) return;
  const double duration = std::clamp(fastest.duration(), allowed.min, allowed.max);
  if (c.adopt(fastest.motion.solution(), duration)) follow(std::move(c), found, session);
}

}  // namespace fjr
