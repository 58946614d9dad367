#include "planner/search/fallbacks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "planner/problem/relaxable.h"
#include "planner/problem/statics.h"
#include "planner/search/guesses.h"
#include "planner/search/slack.h"
#include "planner/search/starts.h"

namespace fjr {
namespace {

using SharedProblem = std::shared_ptr<const Problem>;

double iteration_factor_in(const Session& session) {
  return std::clamp(session.options().budget_factor, 1.0, session.settings().stepwise.most_patience);
}

std::optional<Continuation> try_to_begin(Continuation c, Session& session, const Guess& guess, int iterations) {
  if (session.interrupted() || c.begin(guess, iterations) != StartOutcome::kNew) return std::nullopt;
  return c;
}

std::optional<Continuation> attempt(const SharedProblem& problem, Session& session, const std::string& label,
                                    const Guess& guess, double mesh_factor = 1) {
  Continuation c(problem, session, label, {.mesh_factor = mesh_factor});
  return try_to_begin(std::move(c), session, guess, session.settings().fallbacks.iterations);
}

std::optional<Continuation> attempt_with_more_iterations(const SharedProblem& problem, Session& session,
                                                         const Guess& guess) {
  const FallbackSettings& s = session.settings().fallbacks;
  Continuation c(problem, session, "more iterations", {.regularisation_factor = s.patient_regularisation});
  return try_to_begin(std::move(c), session, guess, s.patient_iterations);
}

// Solves on a new mesh from a smoothed solution, or from another problem's.
std::optional<Continuation> sharpened(const SharedProblem& problem, Session& session, const std::string& label,
                                      const Collocated& from, double width_factor, double mesh_factor = 1) {
  Continuation c(
      problem, session, label,
      {.mesh_factor = mesh_factor, .width_factor = width_factor, .iteration_factor = iteration_factor_in(session)});
  return try_to_begin(std::move(c), session, guess_of(from), session.settings().stepwise.iterations);
}

// Solves from the solution of a neighbouring problem: on its mesh if that is fine enough, and otherwise, or if that
// fails, on a new one.
std::optional<Continuation> follow(const SharedProblem& problem, Session& session, const std::string& label,
                                   const Collocated& from, double width_factor) {
  const double duration = from.motion.duration();
  if (duration / static_cast<double>(from.setup.mesh.size()) <= session.settings().stepwise.longest_interval) {
    Continuation c(problem, session, label, {.iteration_factor = iteration_factor_in(session)});
    if (!session.interrupted() && c.adopt(from, duration)) return c;
  }
  return sharpened(problem, session, label, from, width_factor);
}

// Returns the problem with relaxed limits; a larger factor relaxes more.
using Eased = std::function<Problem(double factor)>;

// A motion within the limits relaxed by that factor; 1 means the problem's own limits.
struct Reached {
  Continuation motion;
  double factor;
};

// Tightens the limits step by step towards the problem's own, each solution starting the next, as far as possible.
// Stops at motions longer than `longest` [s]. width_factor: for solutions on new meshes.
Reached tighten(const SharedProblem& problem, Session& session, const Eased& eased, Reached from, double longest,
                double width_factor) {
  const StepwiseSettings& s = session.settings().stepwise;
  double step = s.first_step;
  while (from.factor > 1 && step >= s.shortest_step && !session.interrupted()) {
    const double target = std::max(1.0, from.factor / (1 + step));
    const SharedProblem tighter = target > 1 ? std::make_shared<const Problem>(eased(target)) : problem;
    const std::string label =
        target > 1 ? fmt::format("limits relaxed by {:.3g} %", 100 * (target - 1)) : "limits tightened step by step";
    auto next = follow(tighter, session, label, from.motion.solution(), width_factor);
    if (next && target > 1 && next->duration() > longest) break;  // and tighter limits take longer
    if (next) {
      const double longer = std::log(next->duration() / from.motion.duration());
      const double growth = longer / std::log(from.factor / target);
      from = {std::move(*next), target};
      step = std::min(s.longer_step * step, s.growth / std::max(growth, 1e-9));
    } else {
      step = std::min(step, from.factor - 1) / 2;
    }
  }
  return from;
}

std::optional<Continuation> tighten_all(const SharedProblem& problem, Session& session, const Guess& guess,
                                        double fraction) {
  const Eased eased = [&](double factor) { return relaxed(*problem, factor - 1); };
  const auto easiest = std::make_shared<const Problem>(eased(1 + fraction));
  auto easy = attempt(easiest, session, fmt::format("limits relaxed by {:.3g} %", 100 * fraction), guess);
  if (!easy) return std::nullopt;
  Reached reached = tighten(problem, session, eased, {std::move(*easy), 1 + fraction}, kNoLimit,
                            session.settings().stepwise.sharp_width_factor);
  if (reached.factor > 1) return std::nullopt;
  return std::move(reached.motion);
}

constexpr std::size_t kTorqueOfJoint1 = Quantities::first_limit<Torque>();

// Factors of the limits, by their index, that carrying the arm slowly takes: at least 1.
using Factors = std::array<double, kLimits>;

Factors factors_to_carry(const Problem& problem) {
  const Limits needed = carrying(problem).needed;
  Factors factors{};
  for (std::size_t i = 0; i < kLimits; ++i) {
    factors[i] = std::max(1.0, kLimitNames[i].in(needed) / kLimitNames[i].in(problem.limits));
  }
  return factors;
}

double largest_of(const Factors& factors) { return *std::max_element(factors.begin(), factors.end()); }

SwungUp swing_up_with(const SharedProblem& problem, double longest, Session& session, double width_factor) {
  const Factors factors = factors_to_carry(*problem);
  const Eased eased = [&](double factor) {
    Problem result = *problem;
    for (std::size_t i = 0; i < kLimits; ++i) {
      if (factors[i] > 1) kLimitNames[i].in(result.limits) *= factor;
    }
    return result;
  };
  const double easily = session.settings().swing_up.easily_carried * largest_of(factors);
  const auto easy = std::make_shared<const Problem>(eased(easily));
  const std::string label = "limits with which the arm can be moved slowly";
  const Guess straight = first_guesses(*easy, session.settings().starts).front();
  const Joints<double> begin = straight.state(0).q, end = straight.state(1).q;
  for (const double back : session.settings().swing_up.winding_up) {
    if (session.interrupted()) break;
    const Joints<double> away{back * (end[0] - begin[0]), back * (end[1] - begin[1])};
    auto carried = attempt(easy, session, label, winding_up_guess(straight, away));
    if (carried) carried = sharpened(easy, session, label, carried->solution(), width_factor);
    if (!carried) continue;
    Reached reached = tighten(problem, session, eased, {std::move(*carried), easily}, longest, width_factor);
    if (reached.factor > 1) return {std::nullopt, eased(reached.factor).limits};
    // On the coarse mesh a motion may get up only because of the mesh's errors.
    if (auto finer = sharpened(problem, session, "swung up, finer mesh", reached.motion.solution(), width_factor,
                               session.settings().fallbacks.finer)) {
      return {std::move(*finer), std::nullopt};
    }
    return {std::move(reached.motion), std::nullopt};
  }
  return {};
}

// Returns the period [s] of small oscillations of the hanging arm, taken as rigid and stretched.
double period_of(const Problem& problem) {
  const MassMatrix<double> stretched = mass_matrix(problem.robot, 0.0);
  const double inertia = stretched.m11 + problem.robot.motor.inertia[0];
  const Joints<double> gravity = gravity_coefficients(problem.robot);
  return 2 * std::numbers::pi * std::sqrt(inertia / (gravity[0] + gravity[1]));
}

// Returns whether the folding guess suits the problem: joint 1 alone lacks torque, and much of it, and the motion is
// the fastest one from rest to rest, without via points or task.
bool folding_helps(const Problem& problem, double much_too_heavy) {
  const Factors factors = factors_to_carry(problem);
  const auto lacking = std::count_if(factors.begin(), factors.end(), [](double factor) { return factor > 1; });
  const bool plain = problem.via.empty() && problem.start_at_rest && problem.goal.at_rest &&
                     count_of_rows(problem.task) == 0 && only_time(problem.weights);
  return plain && lacking == 1 && factors[kTorqueOfJoint1] > much_too_heavy;
}

Relaxable torque_of_joint_1(const Problem& problem) {
  for (const Relaxable& what : relaxables(problem)) {
    if (what.indices == std::vector{kTorqueOfJoint1}) return what;
  }
  throw std::logic_error("torque cannot be relaxed");
}

// Finds the least torque of joint 1 that gets the arm up in `duration` [s], and a motion with smoothed friction that
// needs no more.
std::optional<Continuation> least_torque(const Problem& problem, const Relaxable& torque, double duration,
                                         const std::function<Guess(const Problem&)>& guess, double width_factor,
                                         int most_iterations, Session& session) {
  Problem timed = with_slack(problem, torque, session.settings().slack);
  timed.duration = {duration, duration};
  const auto shared = std::make_shared<const Problem>(std::move(timed));
  Continuation lifted(shared, session, "least torque of a swing-up",
                      {.mesh_factor = session.settings().swing_up.mesh_factor, .width_factor = width_factor});
  return try_to_begin(std::move(lifted), session, guess(*shared), most_iterations);
}

// Does the same from a folding guess: with a sharp friction law and, if that fails, with a smoother one.
std::optional<Continuation> lifted_folded(const Problem& problem, const Relaxable& torque, double duration,
                                          double swing, Session& session) {
  const auto folding = [&](const Problem& timed) { return folding_guess(timed, duration, swing); };
  for (const double width_factor :
       {session.settings().stepwise.sharpest_width_factor, session.settings().stepwise.sharp_width_factor}) {
    if (auto lifted = least_torque(problem, torque, duration, folding, width_factor,
                                   session.settings().swing_up.iterations, session)) {
      return lifted;
    }
  }
  return std::nullopt;
}

bool is_lifted(const Continuation& lifted, const Session& session) {
  return lifted.solution().slack <= session.settings().swing_up.negligible_slack;
}

// Shortens a swing-up in a few rounds, each starting the next: half-way to a duration that is too short [s].
Continuation lifted_sooner(const Problem& problem, const Relaxable& torque, Continuation lifted, double too_short,
                           Session& session) {
  for (int round = 0; round < session.settings().swing_up.shortenings && !session.interrupted(); ++round) {
    const double duration = (too_short + lifted.duration()) / 2;
    const auto shortened = [&](const Problem&) {
      return guess_from(lifted.solution().motion, lifted.solution().durations, duration);
    };
    auto sooner = least_torque(problem, torque, duration, shortened, session.settings().stepwise.sharpest_width_factor,
                               session.settings().swing_up.shortening_iterations, session);
    if (sooner && is_lifted(*sooner, session)) {
      lifted = std::move(*sooner);
    } else {
      too_short = duration;
    }
  }
  return lifted;
}

std::optional<Continuation> fastest_from(const SharedProblem& problem, const Continuation& lifted, int most_iterations,
                                         Session& session) {
  Continuation swung(problem, session, "swung up, folded",
                     {.width_factor = session.settings().stepwise.sharpest_width_factor,
                      .iteration_factor = std::max(session.settings().swing_up.patience, iteration_factor_in(session)),
                      .strategy = swinging_strategy()});
  return try_to_begin(std::move(swung), session, guess_of(lifted.solution()), most_iterations);
}

struct Folded {
  SwungUp swung;
  bool torque_is_enough = false;  // a swing-up with smoothed friction exists for one of the durations
};

// Handles arms for which tightening the limits takes ever shorter steps. Finds the least torque that gets the arm up in
// a given time, which is one problem. If that is no more than the limit, the fastest motion is searched from there.
// Shorter swing-ups take longer to find, but are better starts for it.
Folded swing_up_folded(const SharedProblem& problem, double longest, Session& session) {
  const SwingUpSettings& s = session.settings().swing_up;
  const Relaxable torque = torque_of_joint_1(*problem);
  const double period = period_of(*problem), swing = s.swing * period;
  double least = kNoLimit;  // slack
  double too_short = swing;
  // The duration is bounded by `longest`, and not by the larger bound of the search for a fastest motion. With a bound
  // far away, a swing-up with 5.5 N m converged to a motion that is 1.5 % longer, in which motor 1 slips back within
  // the step of its friction. Every round then asked for margins of a third of the torque, each time elsewhere.
  Problem in_time = *problem;
  in_time.duration.max = longest;
  const auto bounded = std::make_shared<const Problem>(std::move(in_time));
  const Limits surely = torque.relaxed(*problem, s.reported_deficit * torque.size()).limits;
  for (const double periods : s.durations) {
    const double duration = std::max(periods * period, problem->duration.min);
    if (duration > longest || session.interrupted()) break;
    const auto lifted = lifted_folded(*problem, torque, duration, swing, session);
    if (!lifted) continue;
    least = std::min(least, lifted->solution().slack);
    if (lifted->solution().slack > s.hopeless_slack) break;
    if (!is_lifted(*lifted, session)) {
      too_short = duration;
      continue;
    }
    auto motion = fastest_from(bounded, *lifted, session.settings().stepwise.iterations, session);
    if (!motion) {
      const Continuation sooner = lifted_sooner(*problem, torque, *lifted, too_short, session);
      motion = fastest_from(bounded, sooner, s.last_iterations, session);
    }
    return {{std::move(motion), surely}, true};
  }
  if (least == kNoLimit) return {};
  return {{std::nullopt, torque.relaxed(*problem, least * torque.size()).limits}, false};
}

}  // namespace

bool can_be_carried(const Problem& problem) { return largest_of(factors_to_carry(problem)) == 1; }

SwungUp swing_up(const SharedProblem& problem, double longest, Session& session) {
  ++session.fallbacks().swinging;
  SwungUp folded;
  if (folding_helps(*problem, session.settings().swing_up.much_too_heavy)) {
    auto [motion, torque_is_enough] = swing_up_folded(problem, longest, session);
    folded = std::move(motion);
    if (folded.motion || (folded.reached && !torque_is_enough)) return folded;
  }
  SwungUp swung = swing_up_with(problem, longest, session, session.settings().stepwise.sharp_width_factor);
  if (!swung.motion && folded.reached) return folded;
  if (!swung.motion || session.options().budget_factor <= 1) return swung;
  const bool finished = swung.motion->follow_homotopy() == Completion::kFinished;
  if (finished && swung.motion->has_sharpest_friction()) return swung;
  SwungUp sharper = swing_up_with(problem, longest, session, session.settings().stepwise.sharpest_width_factor);
  return sharper.motion ? std::move(sharper) : std::move(swung);
}

std::optional<Continuation> fall_back(const SharedProblem& problem, Session& session) {
  const FallbackSettings& s = session.settings().fallbacks;
  Fallbacks& tried = session.fallbacks();
  const std::vector<Guess> guesses = first_guesses(*problem, session.settings().starts);
  for (std::size_t i = 0; i < std::min(s.patient_starts, guesses.size()) && !session.interrupted(); ++i) {
    ++tried.patience;
    if (auto found = attempt_with_more_iterations(problem, session, guesses[i])) return found;
  }
  const std::pair<double, int*> meshes[] = {{s.coarser, &tried.coarser_mesh}, {s.finer, &tried.finer_mesh}};
  for (const auto& [factor, count] : meshes) {
    if (session.interrupted()) return std::nullopt;
    ++*count;
    if (auto found = attempt(problem, session, factor < 1 ? "coarser mesh" : "finer mesh", guesses.front(), factor)) {
      return found;
    }
  }
  for (const double fraction : s.relaxed) {
    if (session.interrupted()) return std::nullopt;
    ++tried.relaxed_limits;
    if (auto found = tighten_all(problem, session, guesses.front(), fraction)) return found;
  }
  return std::nullopt;
}

}  // namespace fjr
