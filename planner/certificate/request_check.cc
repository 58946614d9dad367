#include "planner/certificate/request_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/certificate/comparison.h"
#include "planner/certificate/residual.h"
#include "planner/certificate/thresholds.h"
#include "planner/problem/task/task.h"

namespace fjr {
namespace {

constexpr double kMet = 1e-7;     // [rad], [rad/s]: a hundred times the optimiser's constraint tolerance
constexpr double kPassed = 1e-5;  // [rad] between rows the interpolation of positions is good to 1e-6

bool differ(const Joints<double>& a, const Joints<double>& b) {
  return std::max(std::abs(a[0] - b[0]), std::abs(a[1] - b[1])) > kMet;
}

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

// Checks the task at the start and at the instants at which rollouts are compared, at most 0.25 ms apart. Between them
// an acceleration of 1000 m/s^2 makes 8e-6 m, which is what the base margin leaves.
std::vector<TaskCheck> check_task(const Parameters& robot, const Task& task, const std::vector<double>& ends,
                                  const Trajectory& trajectory) {
  if (count_of_rows(task) == 0 || ends.empty()) return {};
  std::vector<std::vector<TaskRow>> rows;
  for (std::size_t s = 0; s < ends.size(); ++s) rows.push_back(task_rows(robot, task, s));
  TaskChecks found(rows.front());  // rows of other segments differ only in their numbers
  Interpolator plan(trajectory);
  std::size_t segment = 0;
  std::vector<double> instants = comparison_instants(trajectory);
  instants.insert(instants.begin(), trajectory.start_time());
  for (const double time : instants) {
    while (segment + 1 < ends.size() && time > ends[segment]) ++segment;
    const auto posture = Posture<double>::of(robot, plan.at(time).state.q);
    for (std::size_t r = 0; r < rows[segment].size(); ++r) {
      const TaskRow& row = rows[segment][r];
      TaskCheck& check = found.checks[found.of_row[r]];
      const double clearance = row.distance(row.value(robot, posture));
      if (clearance < check.clearance) {
        check.clearance = clearance;
        check.time = time;
      }
      check.passed = check.passed && clearance >= -kPublishedFraction * row.scale;
    }
  }
  return std::move(found.checks);
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
    const double off = std::max(std::abs(x.q[0] - via.q[0]), std::abs(x.q[1] - via.q[1]));
    const bool late = via.time && std::abs(ends[i] - *via.time) > kMet;
    if (late) fail(fmt::format("via point {} is passed at {:.6f} s instead of {:.6f} s", i + 1, ends[i], *via.time));
    if (via.dq && std::max(std::abs(x.dq[0] - (*via.dq)[0]), std::abs(x.dq[1] - (*via.dq)[1])) >
                      link_velocity_tolerance(problem.robot)) {
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
