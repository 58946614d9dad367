#include "planner/certificate/request_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include "planner/certificate/comparison.h"
#include "planner/certificate/residual.h"
#include "planner/certificate/task_of_motion.h"
#include "planner/certificate/thresholds.h"
#include "planner/problem/task/task.h"

namespace fjr {
namespace {

constexpr double kMet = 1e-7;     // [rad], [rad/s]: a hundred times the optimiser's constraint tolerance
constexpr double kPassed = 1e-5;  // [rad] between rows the interpolation of positions is good to 1e-6

bool differ(const Joints<double>& a, const Joints<double>& b) { return largest_difference(a, b) > kMet; }

bool is_start(const State<double>& x, const State<double>& start) {
  return !differ(x.q, start.q) && !differ(x.dq, start.dq) && !differ(x.theta, start.theta) &&
         !differ(x.dtheta, start.dtheta);
}

bool is_goal(const State<double>& x, const Goal& goal) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!goal.free[j] && std::abs(x.q[j] - goal.q[j]) > kMet) return false;
  }
  return (goal.dq_free || !differ(x.dq, goal.dq)) && !(goal.theta && differ(x.theta, *goal.theta)) &&
         !(goal.dtheta && differ(x.dtheta, *goal.dtheta));
}

// Checks of a task: one for all rows of a constraint that belong to one link. of_row: the check that each row belongs
// to.
struct TaskChecks {
  std::vector<TaskCheck> checks;
  std::vector<std::size_t> of_row;

  explicit TaskChecks(const std::vector<TaskRow>& rows) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const auto same = std::find_if(rows.begin(), rows.end(), [&row = rows[r]](const TaskRow& other) {
        return other.constraint == row.constraint && other.link == row.link;
      });
      const auto first = static_cast<std::size_t>(same - rows.begin());
      of_row.push_back(first < r ? of_row[first] : checks.size());
      if (first == r) checks.push_back({rows[r].name, rows[r].link, rows[r].unit(), kNoLimit, 0, true});
    }
  }
};

// The clearances of a motion from a task. They are evaluated at the ends of its segments, at the instants at which
// rollouts are compared (at most 0.25 ms apart), and between the neighbours of an instant at which a clearance is
// least: a link moves 1 mm from one instant to the next, and may have passed through something thinner.
class Clearances {
 public:
  Clearances(const Parameters& robot, const Task& task, const std::vector<double>& ends, const Trajectory& trajectory)
      : robot_(robot),
        along_(TaskOfMotion::of(robot, task, ends)),
        start_(trajectory.start_time()),
        end_(trajectory.end_time()),
        instants_(comparison_instants(trajectory)),
        plan_(trajectory),
        found_(along_.rows.front()) {}

  std::vector<TaskCheck> check() {
    for (std::size_t s = 0; s < along_.rows.size(); ++s) check_segment(along_.rows[s], instants_of(s));
    return std::move(found_.checks);
  }

 private:
  static constexpr double kResolution = 1e-9;  // [s], in which nothing moves by more than 1e-7 m

  // Returns the instants of a segment, its ends included.
  std::vector<double> instants_of(std::size_t segment) const {
    const double from = segment == 0 ? start_ : std::min(along_.ends[segment - 1], end_);
    const double to = segment + 1 == along_.ends.size() ? end_ : std::min(along_.ends[segment], end_);
    std::vector<double> instants{from};
    std::copy(std::upper_bound(instants_.begin(), instants_.end(), from),
              std::lower_bound(instants_.begin(), instants_.end(), to), std::back_inserter(instants));
    if (to > from) instants.push_back(to);
    return instants;
  }

  void check_segment(const std::vector<TaskRow>& rows, const std::vector<double>& instants) {
    const std::vector<double> none(rows.size(), kNoLimit);
    std::vector<double> before = none, here = none, next = at_instant(rows, instants.front());
    for (std::size_t i = 0; i < instants.size(); ++i) {
      before = std::exchange(here, std::exchange(next, {}));
      next = i + 1 < instants.size() ? at_instant(rows, instants[i + 1]) : none;
      for (std::size_t r = 0; r < rows.size(); ++r) {  // of equal ones, as at a rest, the first is least
        if (!(here[r] < before[r]) || !(here[r] <= next[r])) continue;
        look_between(instants[i > 0 ? i - 1 : 0], instants[std::min(i + 1, instants.size() - 1)], rows[r], r, here[r]);
      }
    }
  }

  // Includes the clearances of all rows at an instant, and returns them.
  std::vector<double> at_instant(const std::vector<TaskRow>& rows, double time) {
    const State<double> x = plan_.at(time).state;
    const auto posture = Posture<double>::of(robot_, x.q);
    speed_ = std::max({speed_, std::abs(x.dq[0]), std::abs(x.dq[1])});
    std::vector<double> clearances;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      clearances.push_back(rows[r].distance(rows[r].value(robot_, posture)));
      include(rows[r], r, clearances.back(), time);
    }
    return clearances;
  }

  void include(const TaskRow& row, std::size_t r, double clearance, double time) {
    TaskCheck& check = found_.checks[found_.of_row[r]];
    if (clearance < check.clearance) {
      check.clearance = clearance;
      check.time = time;
    }
    check.passed = check.passed && clearance >= -kPublishedFraction * row.scale;
  }

  // Includes the least clearance of a row between two times, found by golden sections, unless links of twice the speed
  // could not take away the clearance [m or rad] that there is.
  void look_between(double from, double to, const TaskRow& row, std::size_t r, double clearance) {
    if (clearance > moved_by(robot_, row, 2 * speed_ * (to - from))) return;
    constexpr double kGolden = 0.6180339887498949;
    const auto at = [&](double time) {
      return row.distance(row.value(robot_, Posture<double>::of(robot_, plan_.at(time).state.q)));
    };
    double a = to - kGolden * (to - from), b = from + kGolden * (to - from), at_a = at(a), at_b = at(b);
    while (to - from > kResolution) {
      if (at_a < at_b) {
        to = std::exchange(b, a);
        at_b = at_a;
        a = to - kGolden * (to - from);
        at_a = at(a);
      } else {
        from = std::exchange(a, b);
        at_a = at_b;
        b = from + kGolden * (to - from);
        at_b = at(b);
      }
    }
    include(row, r, std::min(at_a, at_b), std::midpoint(from, to));
  }

  const Parameters& robot_;
  const TaskOfMotion along_;
  const double start_, end_;            // [s]
  const std::vector<double> instants_;  // [s]
  Interpolator plan_;
  TaskChecks found_;
  double speed_ = 0;  // [rad/s] of the links so far
};

std::vector<TaskCheck> check_task(const Parameters& robot, const Task& task, const std::vector<double>& ends,
                                  const Trajectory& trajectory) {
  if (count_of_rows(task) == 0 || ends.empty()) return {};
  return Clearances(robot, task, ends, trajectory).check();
}

}  // namespace

void check_against_request(const Problem& problem, const std::vector<double>& ends, const Trajectory& trajectory,
                           Certificate& certificate) {
  const auto fail = [&certificate](std::string what) {
    certificate.certified = false;
    certificate.failures.push_back(std::move(what));
  };
  if (!is_start(trajectory.samples.front().state, problem.start)) fail("the first row is not the start");
  if (!is_goal(trajectory.samples.back().state, problem.goal)) fail("the last row is not the goal");
  if (problem.goal.at_rest && !is_at_rest(problem.robot, trajectory.samples.back()))
    fail("the motion does not end at rest");
  if (trajectory.end_time() < problem.duration.min - kMet || trajectory.end_time() > problem.duration.max + kMet) {
    fail(fmt::format("the motion takes {:.6f} s", trajectory.end_time()));
  }
  Interpolator at(trajectory);
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    const Via& via = problem.via[i];
    const State<double> x = at.at(ends[i]).state;
    const double off = largest_difference(x.q, via.q);
    const bool late = via.time && std::abs(ends[i] - *via.time) > kMet;
    if (late) fail(fmt::format("via point {} is passed at {:.6f} s instead of {:.6f} s", i + 1, ends[i], *via.time));
    if (via.dq && largest_difference(x.dq, *via.dq) > link_velocity_tolerance(problem.robot)) {
      fail(fmt::format("via point {} is passed at another velocity", i + 1));
    }
    if (off > via.tolerance + kPassed) fail(fmt::format("via point {} is missed at {:.6f} s", i + 1, ends[i]));
  }
  check_against_task(problem.robot, problem.task, ends, trajectory, certificate);
}

void check_against_task(const Parameters& robot, const Task& task, const std::vector<double>& ends,
                        const Trajectory& trajectory, Certificate& certificate) {
  certificate.task = check_task(robot, task, ends, trajectory);
  for (const TaskCheck& check : certificate.task) {
    if (check.passed) continue;
    certificate.certified = false;
    certificate.failures.push_back(fmt::format("{}{} is missed by {:.3g} {} at {:.6f} s", check.name,
                                               check.link == 0 ? "" : fmt::format(" (link {})", check.link),
                                               -check.clearance, check.unit, check.time));
  }
}

}  // namespace fjr
