// The certificate that is published with a trajectory: results of rollouts of its rows on the exact model.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/dynamics.h"
#include "planner/problem/quantities.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Returns one count of the link encoder [rad], the finer one if the joints differ: 2 pi / 65536 = 9.59e-5 rad for 65536
// counts.
double exactness_tolerance(const Parameters& p);

struct RolloutErrors {          // rollout minus plan, largest magnitude over time and joints
  Joints<double> link{};        // [rad] per joint
  Joints<double> motor{};       // [rad] per joint
  Joints<double> final_link{};  // [rad] at the end
  double time_of_max_link = 0;  // [s]
  bool completed = false;       // false: the integration broke down; `failure` says why
  std::string failure;

  double max_link() const;
  double max_motor() const;
  double max_final_link() const;
};

// A stretch of the plan where the arm itself amplifies errors so much that no open-loop run across it can be exact.
struct Stretch {
  double from = 0, to = 0;  // [s] equal: an instant
  int joint = 0;            // 1 or 2: its motor rests in its unstable band; 0: gravity amplifies
  std::string why;          // one sentence, with times
};

// The open-loop rollout from the start to the end. Within a stretch the resting motor alone has its feedback; at the
// end of a stretch the run begins again in the plan's own state. Link errors count at all times.
struct OpenLoop : RolloutErrors {
  std::vector<Stretch> stretches;  // none: one run from the start to the end

  std::string why_not_in_one_run() const;  // the reasons of all stretches; empty when there are none
};

// The closed-loop rollout from perturbed starts, half a count off, at which the link encoders still read the start
// (perturbed.h).
struct Perturbed {
  bool evaluated = false;  // only if nothing else has failed
  bool completed = false;
  Joints<double> link{};        // [rad] rollout minus plan, largest magnitude per joint
  double time_of_max_link = 0;  // [s]
  Joints<double> after{};       // [rad] |q - q_goal|, largest in the second after an end at rest; 0 after another

  double max_link() const;
};

struct ClosedLoop : RolloutErrors {
  Joints<double> feedback_torque{};  // [N m] largest magnitude per joint
  Perturbed perturbed;
};

// One limit compared with the largest values of the published rows with their interpolation, and of the closed-loop
// rollout.
struct LimitCheck {
  std::string name;    // a name of Quantities (planner/problem/quantities.h)
  int joint = 0;       // 1 or 2; 0 for a limit of the tip
  double limit = 0;    // magnitude, in the limit's unit
  double reached = 0;  // largest magnitude of the published rows with their interpolation
  double time = 0;     // [s] where
  double rollout = 0;  // largest magnitude in the closed-loop rollout
  bool passed = false;
  std::size_t index = 0;  // in kLimitNames

  double margin() const { return limit - reached; }
};

// One constraint of the request's task, compared with the published rows and their interpolation.
struct TaskCheck {
  std::string name;      // a name of each_constraint() (planner/problem/task/task.h)
  int link = 0;          // 1 or 2 for what links keep clear of; 0: neither
  std::string unit;      // m or rad
  double clearance = 0;  // least distance from the forbidden region; negative: violated
  double time = 0;       // [s] where
  bool passed = false;
};

// Motion after the end, held by the torque G(q_goal) for a fixed window. It begins where the rollouts from the exact
// start ended.
struct Residual {
  bool evaluated = false;            // only for a trajectory that ends at rest
  double window = 0;                 // [s]
  Joints<double> link_vibration{};   // [rad] largest |q - q_goal|, closed loop
  Joints<double> open_loop_drift{};  // [rad] the same without feedback: motor 2 is unstable at rest
};

// Prediction of the run on the hardware: torque held over the tick, encoder counts, filtered differentiation,
// motor-side feedback, drive peak torque. Reported, never part of the verdict.
struct Tracking {
  Joints<double> link_error{};       // [rad] largest
  Joints<double> link_error_rms{};   // [rad]
  Joints<double> feedback_torque{};  // [N m] largest
  Joints<double> peak_torque{};      // [N m] largest commanded
  bool saturated = false;            // the drive's peak torque was reached
};

// One limit compared with bounds that are proved to hold at all times.
struct LimitBound {
  std::string name;                 // as in LimitCheck
  int joint = 0;                    // 1 or 2; 0 for tip_speed
  double allowed = 0;               // the limit, with what rounding may take
  double published = 0;             // bound on the magnitudes of the published rows with their interpolation
  std::optional<double> rollout{};  // bound on the exact motion in closed loop; none: only the plan has this limit
};

// One constraint of the task compared with bounds that are proved to hold at all times.
struct TaskBound {
  std::string name;      // as in TaskCheck
  int link = 0;          // 1 or 2; 0: neither
  std::string unit;      // m or rad
  double published = 0;  // least clearance of the rows with their interpolation; negative: may violate it by that
  double time = 0;       // [s] where that may be
  double rollout = 0;    // the same of the exact motion in closed loop, until closed_loop.until
};

// Bounds of the exact motion that are proved, and not only computed to an integrator's accuracy (proof/prove.h).
struct Proof {
  struct Loop {
    bool proven = false;               // to the end, and within what is allowed
    double until = 0;                  // [s] how far
    std::string reason;                // why no further; empty when proven
    Joints<double> link{};             // [rad]   |exact motion - plan| is never larger, until then
    double time_of_max_link = 0;       // [s] where it may be that large
    Joints<double> link_velocity{};    // [rad/s] likewise; closed loop only
    Joints<double> motor_velocity{};   // [rad/s] likewise; closed loop only
    Joints<double> feedback_torque{};  // [N m]  likewise; closed loop only
    double width = 0;                  // [rad] largest uncertainty of a link in the enclosure
    long steps = 0;
  };
  bool evaluated = false;
  bool proven = false;
  double until = 0;    // [s] up to which all of it is proven
  std::string reason;  // "not proven from t = ...: ..."; empty when proven
  Loop open_loop, closed_loop;
  std::vector<LimitBound> limits;
  std::vector<TaskBound> task;
};

// Effect of the uncertainty of the arm's parameters on a motion in the executor's closed loop (robust/robustness.h).
struct Robustness {
  // The margin of a limit or a row of the task, at the time when least of it is left.
  struct Margin {
    std::string name;  // as in LimitCheck and TaskCheck
    int joint = 0;     // 1 or 2; the link for a row of the task; 0: neither
    std::string unit;
    double limit = 0;   // the one that holds with feedback; infinite for a row of the task
    double factor = 0;  // half width of the tube in standard deviations
    double needed = 0;  // at `time`
    double there = 0;   // in the plan: limit - |value|, the clearance, or the tolerance less the distance from a line
    double time = 0;    // [s]
    std::string parameter;  // the one whose exact value would reduce the margin's square most; empty if encoder counts
                            // matter more
    double fraction = 0;    // fraction of that square by which it would be reduced
    bool passed = false;
    std::size_t index = 0;       // in kLimitNames, or after those the row of the task
    std::vector<double> tube{};  // half width at Robustness::times, in `unit`
    // By how much the half width would be smaller at these times if each of Robustness::names had half its error.
    std::vector<std::vector<double>> halved{};
  };
  // Effects that the uncertainty of the parameters does not cover.
  static constexpr const char* kNotCovered = "link damping that is not modelled, hysteresis, temperature";

  bool evaluated = false;
  bool kept = false;      // every margin is there
  std::string reason;     // why not; empty when kept
  double confidence = 0;  // at least this fraction of the possible arms stays in all tubes at all times
  double certainty = 0;   // confidence level of that statement, which is found by drawing arms
  std::size_t arms = 0;   // that were drawn
  std::size_t parameters = 0, directions = 0;  // uncertain ones, and the rank of their covariance
  double first_order = 0;                      // factor of the tubes by linear theory alone
  double ellipsoid = 0;                        // factor of an ellipsoid that contains that fraction of the parameters
  Joints<double> link{};                       // [rad] the links stay that close to the plan
  std::vector<Margin> limits, task;
  std::vector<double> times;              // [s] of the tubes
  Joints<std::vector<double>> link_tube;  // [rad]
  // Each parameter, and the fraction of the margins' squares that knowing it exactly would take away, largest first. It
  // is the mean over limits, weighted by the fraction of the available margin that each of them needs.
  std::vector<std::pair<std::string, double>> costs;
  std::vector<std::string> names;  // of the parameters

  // For a plan made with these margins, in units of the objective: what the margins cost, and what knowing each
  // parameter twice as well would give back, to first order by the shadow prices, largest first.
  std::optional<double> price;
  std::vector<std::pair<std::string, double>> savings;
};

struct Certificate {
  bool certified = false;
  std::vector<std::string> failures;  // one sentence each, empty when certified
  double tolerance = 0;               // [rad]
  OpenLoop open_loop;
  ClosedLoop closed_loop;
  std::vector<LimitCheck> limits;
  std::vector<TaskCheck> task;  // empty if the request has none, and for a trajectory without request
  Residual residual;
  Tracking tracking;
  Proof proof;            // if it was requested
  Robustness robustness;  // if it was requested
};

// Certifies a trajectory for a robot, with residual motion and tracking. limits: the robot's or tighter ones. A
// trajectory that ends with dq = dtheta = 0 in equilibrium is taken to end at rest.
Certificate certify(const Parameters& robot, const Limits& limits, const Trajectory& trajectory);

}  // namespace fjr
