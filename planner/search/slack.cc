#include "planner/search/slack.h"

#include <algorithm>
#include <cmath>

#include "planner/ocp/margins.h"
#include "planner/problem/relaxable.h"
#include "planner/problem/task/task.h"

namespace fjr {
namespace {

constexpr double kDifference = 1e-6;  // step by which a region's bounds are differentiated

bool is_obstacle(const Relaxable& what) { return what.constraint == &kInfo<Disc>; }
bool is_velocity(const Relaxable& what) { return what.kind == RelaxableKind::kVelocity; }

// Returns the distance [m] from an obstacle's centre that a link still keeps at a slack of one: its own radius. The
// squared distance is relaxed, because the rows are linear in it.
double least_apart(const Problem& problem, const TaskRow& row) {
  return problem.robot.link.radius[static_cast<std::size_t>(row.link - 1)];
}

void relax_rows(const Problem& problem, const Relaxable& what, std::vector<double>& direction) {
  const std::vector<TaskRow> rows = task_rows(problem.robot, problem.task, 0);
  if (is_obstacle(what)) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const double apart = rows[r].number, least = rows[r].link > 0 ? least_apart(problem, rows[r]) : apart;
      if (rows[r].constraint == what.number) direction[kLimits + r] += (apart * apart - least * least) / (2 * apart);
    }
    return;
  }
  const Problem wider = what.relaxed(problem, kDifference);
  const std::vector<TaskRow> after = task_rows(wider.robot, wider.task, 0);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].constraint != what.number) continue;
    const double moved = rows[r].number - after[r].number;  // value() counts from there
    const double below = rows[r].lower - after[r].lower + moved, above = after[r].upper - rows[r].upper - moved;
    const double more = std::isfinite(below) ? below : above;
    direction[kLimits + r] += more / kDifference * what.size();
  }
}

void relax(const Problem& problem, const Relaxable& what, std::vector<double>& direction) {
  if (what.kind == RelaxableKind::kAllLimits || what.kind == RelaxableKind::kBothJoints) {
    const Limits larger = what.relaxed(problem, 1).limits;
    for (std::size_t i = 0; i < kLimits; ++i) {
      const double limit = kLimitNames[i].in(problem.limits);
      if (std::isfinite(limit)) direction[i] += kLimitNames[i].in(larger)-limit;
    }
    return;
  }
  if (what.kind == RelaxableKind::kLimit) {
    direction[what.indices.front()] += what.size();
  } else {
    relax_rows(problem, what, direction);
  }
}

Problem with_unused_slack(const Problem& problem, double time_weight) {
  Problem result = problem;
  result.weights = {.time = time_weight};
  result.variation.pause.reset();
  result.variation.slack.emplace();
  result.variation.slack->direction.assign(limit_scales(problem).size(), 0.0);
  return result;
}

}  // namespace

Problem with_slack(const Problem& problem, const Relaxable& what, const SlackSettings& settings) {
  Problem result = with_unused_slack(problem, settings.time_weight);
  Slack& slack = *result.variation.slack;
  if (is_velocity(what)) {
    slack.velocity = what.number;
    slack.most = 1;
  } else {
    relax(problem, what, slack.direction);
    slack.most = is_obstacle(what) ? 1 : std::min(settings.most, what.most / what.size());
  }
  return result;
}

Problem with_slack_everywhere(const Problem& problem, const SlackSettings& settings) {
  Problem result = with_unused_slack(problem, settings.time_weight);
  for (const Relaxable& what : relaxables(problem)) {
    if (!is_velocity(what)) relax(problem, what, result.variation.slack->direction);
  }
  result.variation.slack->most = settings.most;
  return result;
}

Problem with_larger_time_weight(Problem with_slack, const SlackSettings& settings) {
  with_slack.weights.time = settings.larger_time_weight;
  return with_slack;
}

double value_with(const Problem& problem, const Relaxable& what, double slack) {
  if (!is_obstacle(what)) return what.value(slack * what.size());
  double value = what.from;
  for (const TaskRow& row : task_rows(problem.robot, problem.task, 0)) {
    if (row.constraint != what.number) continue;
    const double least = least_apart(problem, row);
    const double squared = row.number * row.number - slack * (row.number * row.number - least * least);
    value = std::min(value, std::sqrt(std::max(0.0, squared)) - least);
  }
  return value;
}

}  // namespace fjr
