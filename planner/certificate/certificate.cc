#include "planner/certificate/certificate.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>

#include "planner/certificate/amplification.h"
#include "planner/certificate/comparison.h"
#include "planner/certificate/consistency.h"
#include "planner/certificate/judge.h"
#include "planner/certificate/limits.h"
#include "planner/certificate/perturbed.h"
#include "planner/certificate/residual.h"
#include "planner/certificate/thresholds.h"
#include "planner/certificate/tracking.h"
#include "planner/control/motor_feedback.h"

namespace fjr {
namespace {

double larger(const Joints<double>& p) { return std::max(p[0], p[1]); }

// Collects the reasons for not certifying a trajectory.
class Verdict {
 public:
  Verdict(const Parameters& robot, Certificate& certificate) : robot_(robot), certificate_(certificate) {}

  void refuse(std::optional<std::string> reason) {
    if (reason) certificate_.failures.push_back(std::move(*reason));
  }

  void judge_exactness(const std::string& loop, const RolloutErrors& errors) {
    if (!errors.completed) return refuse(loop + ": " + errors.failure);
    if (errors.max_link() <= certificate_.tolerance) return;
    const int joint = errors.link[0] >= errors.link[1] ? 1 : 2;
    refuse(fmt::format("{}: link {} is up to {:.2e} rad off the plan ({:.6f} s), allowed {:.2e} rad", loop, joint,
                       errors.max_link(), errors.time_of_max_link, certificate_.tolerance));
  }

  void judge_velocity(const Comparison& closed) {
    const double error = larger(closed.link_velocity_error), allowed = rollout_velocity_tolerance(robot_);
    if (error <= allowed) return;
    const int joint = closed.link_velocity_error[0] >= closed.link_velocity_error[1] ? 1 : 2;
    refuse(fmt::format(
        "closed loop: the velocity of link {} is up to {:.2e} rad/s off the plan ({:.6f} s), allowed {:.2e} rad/s",
        joint, error, closed.time_of_max_link_velocity, allowed));
  }

  void judge_motor_velocity(const Comparison& closed) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double error = closed.motor_velocity_error[j];
      const double allowed = rollout_motor_velocity_tolerance(robot_)[j];
      if (error <= allowed) continue;
      refuse(fmt::format(
          "closed loop: the velocity of motor {} is up to {:.2e} rad/s off the plan ({:.6f} s), allowed {:.2e} rad/s",
          j + 1, error, closed.time_of_max_motor_velocity[j], allowed));
    }
  }

  void judge_feedback(const Comparison& closed) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double allowed = feedback_limit(robot_)[j];
      if (closed.feedback_torque[j] < allowed) continue;
      refuse(fmt::format(
          "closed loop: feedback torque of joint {} reaches {:.3g} N m at {:.6f} s, allowed {:.3g} N m ({:g} % of "
          "the torque limit)",
          j + 1, closed.feedback_torque[j], closed.time_of_feedback[j], allowed, 100 * kFeedbackFraction));
    }
  }

  void judge_perturbed(const Perturbed& perturbed) {
    if (!perturbed.completed) return refuse("closed loop from half a count off the start: the integration broke down");
    const Joints<double> off{start_offset(robot_, 0), start_offset(robot_, 1)};
    const double allowed = 2 * larger(off);  // one count of the coarser encoder
    const auto judge = [&](const Joints<double>& link, const std::string& when) {
      if (larger(link) <= allowed) return;
      refuse(
          fmt::format("closed loop from half a count off the start: link {} is up to {:.2e} rad off the plan {}, "
                      "allowed {:.2e} rad",
                      link[0] >= link[1] ? 1 : 2, larger(link), when, allowed));
    };
    judge(perturbed.link, fmt::format("({:.6f} s)", perturbed.time_of_max_link));
    judge(perturbed.after, "in the second after the end, when held by the robot's feedback");
  }

  void judge_limits() {
    for (const LimitCheck& check : certificate_.limits) {
      if (!check.passed) refuse(violation(check, Limits::of(robot_)));
    }
  }

  void judge_closed_loop(const Comparison& closed) {
    judge_exactness("closed loop", certificate_.closed_loop);
    judge_velocity(closed);
    judge_motor_velocity(closed);
    judge_feedback(closed);
    judge_limits();
  }

 private:
  const Parameters& robot_;
  Certificate& certificate_;
};

// These functions roll out and store what is measured; they judge nothing.
Comparison measure_open_loop(const Parameters& robot, Rollout& rollout, const Trajectory& trajectory, Certificate& c) {
  c.open_loop.stretches = stretches_of_amplification(robot, trajectory);
  const Comparison open =
      compare(rollout, robot, trajectory, open_loop_pieces(robot, trajectory, c.open_loop.stretches),
              comparison_instants(trajectory));
  static_cast<RolloutErrors&>(c.open_loop) = open.errors;
  return open;
}

Comparison measure_closed_loop(const Parameters& robot, const Limits& limits, Rollout& rollout,
                               const Trajectory& trajectory, Certificate& c) {
  const Comparison closed =
      compare(rollout, robot, trajectory, Drive::closed_loop(trajectory, robot), comparison_instants(trajectory));
  static_cast<RolloutErrors&>(c.closed_loop) = closed.errors;
  c.closed_loop.feedback_torque = closed.feedback_torque;
  c.limits = check_limits(robot, limits, trajectory, closed);
  return closed;
}

// The rollouts of a certificate. Each part fills its own members of the certificate, so that all of them can be rolled
// out at the same time.
class Rollouts {
 public:
  static constexpr std::size_t kParts = 3 + PerturbedRollouts::kStarts;

  Rollouts(const Parameters& robot, const Limits& limits, const Trajectory& trajectory, Certificate& certificate)
      : robot_(robot),
        limits_(limits),
        trajectory_(trajectory),
        certificate_(certificate),
        ends_at_rest_(is_at_rest(robot, trajectory.samples.back())),
        perturbed_(robot, trajectory) {}

  // The longest parts, and those that others depend on, come first.
  void roll_out(std::size_t part) {
    if (part == 0) return roll_out_closed_loop();
    if (part == 1) return roll_out_open_loop();
    if (part == kParts - 1) {
      certificate_.tracking = predict_tracking(robot_, trajectory_);
    } else if (!failed_) {
      perturbed_.roll_out(part - 2);
    }
  }

  const Comparison& closed() const { return closed_; }
  Perturbed perturbed() const { return perturbed_.worst(); }  // valid if neither loop has failed

 private:
  void roll_out_open_loop() {
    Rollout rollout(robot_, rollout_allowance(robot_, limits_), Accuracy::of_certificates());
    const Comparison open = measure_open_loop(robot_, rollout, trajectory_, certificate_);
    stop_where_failed(open.errors);
    if (ends_at_rest_) {
      certificate_.residual.open_loop_drift = drift_at_rest(robot_, trajectory_.samples.back(), open.final);
    }
  }

  void roll_out_closed_loop() {
    Rollout rollout(robot_, rollout_allowance(robot_, limits_), Accuracy::of_certificates());
    closed_ = measure_closed_loop(robot_, limits_, rollout, trajectory_, certificate_);
    stop_where_failed(closed_.errors);
    if (!ends_at_rest_ || !closed_.errors.completed) return;
    certificate_.residual.evaluated = true;
    certificate_.residual.window = kResidualWindow;
    certificate_.residual.link_vibration = deviation_at_rest(robot_, trajectory_.samples.back(), closed_.final);
  }

  // Once the trajectory cannot be certified, perturbed starts are not rolled out.
  void stop_where_failed(const RolloutErrors& errors) {
    if (!errors.completed || errors.max_link() > certificate_.tolerance) failed_ = true;
  }

  const Parameters& robot_;
  const Limits& limits_;
  const Trajectory& trajectory_;
  Certificate& certificate_;
  const bool ends_at_rest_;
  Comparison closed_;
  PerturbedRollouts perturbed_;
  std::atomic<bool> failed_ = false;
};

// Makes the checks that need no rollout.
Certificate judge_rows(const Parameters& robot, const Limits& limits, const Trajectory& trajectory) {
  Certificate c;
  c.tolerance = exactness_tolerance(robot);
  Verdict verdict(robot, c);
  verdict.refuse(malformed(trajectory));
  if (!c.failures.empty()) return c;
  c.limits = check_limits(robot, limits, trajectory, {});
  verdict.judge_limits();
  verdict.refuse(inconsistent_velocity(robot, trajectory));
  return c;
}

Certificate judge_closed_loop(const Parameters& robot, const Limits& limits, const Trajectory& trajectory,
                              const Accuracy& accuracy) {
  Certificate c;
  c.tolerance = exactness_tolerance(robot);
  Verdict verdict(robot, c);
  Rollout rollout(robot, rollout_allowance(robot, limits), accuracy);
  verdict.judge_closed_loop(measure_closed_loop(robot, limits, rollout, trajectory, c));
  c.certified = c.failures.empty();
  return c;
}

}  // namespace

double exactness_tolerance(const Parameters& p) { return 2 * std::numbers::pi / larger(p.encoder.link_counts); }

double RolloutErrors::max_link() const { return larger(link); }
double RolloutErrors::max_motor() const { return larger(motor); }
double RolloutErrors::max_final_link() const { return larger(final_link); }

double Perturbed::max_link() const { return larger(link); }

std::string OpenLoop::why_not_in_one_run() const {
  std::string text;
  for (const Stretch& stretch : stretches) text += (text.empty() ? "" : "; ") + stretch.why;
  return text;
}

Certificate certify(const Parameters& robot, const Limits& limits, const Trajectory& trajectory,
                    const ForEach& for_each) {
  Certificate c;
  c.tolerance = exactness_tolerance(robot);
  Verdict verdict(robot, c);
  if (auto reason = malformed(trajectory)) {
    c.open_loop.failure = c.closed_loop.failure = "not rolled out: " + *reason;
    verdict.refuse(std::move(reason));
    return c;
  }
  Rollouts rollouts(robot, limits, trajectory, c);
  for_each(Rollouts::kParts, [&](std::size_t part) { rollouts.roll_out(part); });
  verdict.refuse(inconsistent_velocity(robot, trajectory));
  verdict.judge_exactness("open loop", c.open_loop);
  verdict.judge_closed_loop(rollouts.closed());
  if (c.failures.empty()) {
    c.closed_loop.perturbed = rollouts.perturbed();
    verdict.judge_perturbed(c.closed_loop.perturbed);
  }
  c.certified = c.failures.empty();
  return c;
}

Certificate certify(const Parameters& robot, const Limits& limits, const Trajectory& trajectory) {
  return certify(robot, limits, trajectory, one_after_another);
}

Certificate judge_closed_loop(const Parameters& robot, const Limits& limits, const Trajectory& trajectory) {
  Certificate c = judge_rows(robot, limits, trajectory);
  if (!c.failures.empty()) return c;
  c = judge_closed_loop(robot, limits, trajectory, Accuracy::of_predictions());
  return c.certified ? c : judge_closed_loop(robot, limits, trajectory, Accuracy::of_certificates());
}

}  // namespace fjr
