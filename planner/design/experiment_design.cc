#include "planner/design/experiment_design.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <utility>

#include "common/input_error.h"
#include "planner/identify/planned_information.h"
#include "planner/plan.h"

namespace fjr {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kFarthest = 0.45;               // of a joint's range from its middle, where a motion may end,
constexpr double kFarthestAngle = 1.4;           // [rad] and no farther than this
constexpr double kShortest = 0.3, kLongest = 3;  // [s] at the motors' full speed, between which candidates are drawn
constexpr double kSlowest = 0.02;                // of the motors' speed
constexpr double kLittleLeft = 0.3;              // [s] for which no further motion is looked for
constexpr double kDigits = 1e4;                  // angles and speeds are rounded to four digits, for people

double rounded(double number) { return std::round(number * kDigits) / kDigits; }

// From rest to rest within about `longest`; half of the candidates are slow.
Request drawn(const Parameters& robot, const Joints<double>& from, double longest, std::mt19937_64& random) {
  std::uniform_real_distribution<double> even(-1, 1), slowness(std::log(kSlowest), 0);
  std::uniform_real_distribution<double> lasting(kShortest, std::max(kShortest, std::min(kLongest, longest)));
  const bool slow = std::bernoulli_distribution(0.5)(random);
  const double speed = slow ? std::exp(slowness(random)) : 1;
  const double seconds = lasting(random);
  Request request;
  request.source = "experiment";
  request.start = RequestedStart{from, {}, {}, {}};
  request.objective = Preset::kFastest;
  request.search = Thoroughness::kQuick;
  AnglesOrFree to;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double most = rounded(speed * robot.limits.motor_velocity[j]);
    const double range = std::min(kFarthestAngle, kFarthest * robot.limits.link_position[j]);
    const double middle = robot.limits.link_middle[j];
    to[j] = rounded(std::clamp(from[j] + most * seconds * even(random), middle - range, middle + range));
    if (slow) request.limits.motor_velocity[j] = most;
  }
  request.goal = JointGoal{to, AtRest{}};
  return request;
}

struct Candidate {
  DesignedMotion motion;
  MatrixXd information;
  double gain_rate = 0;  // [1/s] of the log determinant; 0: it cannot be had
};

double log_determinant(const MatrixXd& information) {
  return information.ldlt().vectorD().array().max(1e-300).log().sum();
}

class Designer {
 public:
  Designer(const Parameters& robot, const Prior& prior, const DesignOptions& options)
      : robot_(robot),
        prior_(prior),
        options_(options),
        known_(MatrixXd::Identity(prior.factor.cols(), prior.factor.cols())) {}  // the prior's numbers have variance 1

  bool cancelled() const { return options_.cancelled && options_.cancelled(); }

  // The best motion from there of at most that many seconds, if there is one.
  std::optional<DesignedMotion> next(const Joints<double>& from, double seconds, std::size_t round,
                                     const ForEach& for_each) {
    std::vector<Candidate> candidates(static_cast<std::size_t>(options_.candidates));
    const double before = log_determinant(known_);
    for_each(candidates.size(), [&](std::size_t i) {
      std::seed_seq seeds{options_.seed, static_cast<std::uint64_t>(round), static_cast<std::uint64_t>(i)};
      std::mt19937_64 random(seeds);
      evaluate(drawn(robot_, from, seconds, random), seconds, before, candidates[i]);
    });
    const auto best =
        std::max_element(candidates.begin(), candidates.end(),
                         [](const Candidate& a, const Candidate& b) { return a.gain_rate < b.gain_rate; });
    if (best == candidates.end() || !(best->gain_rate > 0)) return std::nullopt;
    known_ += best->information;
    return std::move(best->motion);
  }

  Eigen::VectorXd errors() const {
    const MatrixXd covariance = prior_.factor * known_.ldlt().solve(MatrixXd(prior_.factor.transpose()));
    return covariance.diagonal().cwiseSqrt();
  }

 private:
  void evaluate(const Request& request, double longest, double before, Candidate& c) const {
    if (cancelled()) return;
    const std::optional<Problem> problem = problem_of(request);
    if (!problem) return;
    PlanOptions options;
    options.cancelled = options_.cancelled;
    Plan planned = plan(*problem, options);
    if (planned.status != PlanStatus::kCertified || planned.duration > longest) return;
    c.motion = {request, std::move(*planned.trajectory)};
    c.information = planned_information(robot_, prior_, c.motion.trajectory);
    c.gain_rate = (log_determinant(known_ + c.information) - before) / planned.duration;
  }

  // None where a random posture cannot be held, or is too near.
  std::optional<Problem> problem_of(const Request& request) const {
    try {
      return resolve_for(request, robot_);
    } catch (const InputError&) {
      return std::nullopt;
    }
  }

  const Parameters& robot_;
  const Prior& prior_;
  const DesignOptions& options_;
  MatrixXd known_;  // information of the prior and of the motions so far
};

// That the arm can rest there: whatever a request from there would be refused for.
void check_start(const Parameters& robot, const Joints<double>& start) {
  Request request;
  request.source = "experiment design";
  request.start = RequestedStart{start, {}, {}, {}};
  const double inwards = start[0] > robot.limits.link_middle[0] ? -1e-2 : 1e-2;  // a goal has to be elsewhere
  request.goal = JointGoal{{start[0] + inwards, start[1]}, AtRest{}};
  (void)resolve_for(request, robot);
}

}  // namespace

double ExperimentDesign::duration() const {
  double sum = 0;
  for (const DesignedMotion& motion : motions) sum += motion.trajectory.end_time() - motion.trajectory.start_time();
  return sum;
}

ExperimentDesign design_experiment(const Parameters& robot, const Prior& prior, const DesignOptions& options,
                                   const ForEach& for_each) {
  check_start(robot, options.start);
  Designer designer(robot, prior, options);
  ExperimentDesign design;
  Joints<double> at = options.start;
  double left = options.duration;
  while (left > kLittleLeft && !designer.cancelled()) {
    std::optional<DesignedMotion> motion = designer.next(at, left, design.motions.size(), for_each);
    if (!motion) break;
    const AnglesOrFree& end = std::get<JointGoal>(motion->request.goal).q;
    at = {*end[0], *end[1]};
    design.motions.push_back(std::move(*motion));
    left = options.duration - design.duration();
    if (options.on_progress) options.on_progress(1 - left / options.duration);
  }
  if (design.motions.empty() && !designer.cancelled()) {
    throw InputError("experiment design", "start", "no motion from there could be planned within the duration");
  }
  design.error = designer.errors();
  return design;
}

}  // namespace fjr
