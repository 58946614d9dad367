#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/sha256.h"
#include "model/uncertainty.h"
#include "planner/problem/task/task.h"
#include "planner/request/problem_settings.h"
#include "planner/request/request.h"
#include "planner/request/words.h"

namespace fjr {
namespace {

// "name=value" lines of everything that decides the plan.
class HashLines {
 public:
  void add(const std::string& name, double value) {
    lines_.push_back(fmt::format("{}={:.17g}\n", name, value + 0.0));  // -0 is 0
  }
  void add(const std::string& name, const Joints<double>& pair) {
    for (std::size_t j = 0; j < kJoints; ++j) add(fmt::format("{}[{}]", name, j), pair[j]);
  }
  void add(const std::string& name, const std::optional<Joints<double>>& pair) {
    pair ? add(name, *pair) : add_text(name, "free");
  }
  void add_text(const std::string& name, std::string_view text) {
    lines_.push_back(fmt::format("{}={}\n", name, text));
  }

  std::string hash() {
    std::sort(lines_.begin(), lines_.end());
    return sha256_hex(fmt::format("{}", fmt::join(lines_, "")));
  }

 private:
  std::vector<std::string> lines_;
};

void add_goal(HashLines& lines, const std::string& name, const Goal& goal) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    const std::string angle = fmt::format("{}.q[{}]", name, j);
    goal.free[j] ? lines.add_text(angle, "free") : lines.add(angle, goal.q[j]);
  }
  goal.dq_free ? lines.add_text(name + ".dq", "free") : lines.add(name + ".dq", goal.dq);
  lines.add(name + ".theta", goal.theta);
  lines.add(name + ".dtheta", goal.dtheta);
}

void add_states(HashLines& lines, const Problem& problem) {
  lines.add("start.q", problem.start.q);
  lines.add("start.dq", problem.start.dq);
  lines.add("start.theta", problem.start.theta);
  lines.add("start.dtheta", problem.start.dtheta);
  add_goal(lines, "goal", problem.goal);
  for (std::size_t i = 0; i < problem.other_goals.size(); ++i) {
    add_goal(lines, fmt::format("other_goals[{}]", i), problem.other_goals[i]);
  }
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    const Via& via = problem.via[i];
    const std::string name = fmt::format("via[{}]", i);
    via.time ? lines.add(name + ".time", *via.time) : lines.add_text(name + ".time", "free");
    lines.add(name + ".q", via.q);
    lines.add(name + ".dq", via.dq);
    if (via.tolerance > 0) lines.add(name + ".tolerance", via.tolerance);
  }
}

void add_setting(HashLines& lines, const char* key, double value) { lines.add(key, value); }
void add_setting(HashLines& lines, const char* key, std::uint64_t value) { lines.add_text(key, std::to_string(value)); }
void add_setting(HashLines& lines, const char* key, Thoroughness value) { lines.add_text(key, word_of(value)); }
void add_setting(HashLines& lines, const char* key, const std::string& value) { lines.add_text(key, value); }
void add_setting(HashLines& lines, const char* key, bool value) {
  if (value) lines.add_text(key, "asked for");
}
void add_setting(HashLines& lines, const std::string& key, const std::optional<double>& confidence) {
  if (confidence) lines.add(key + ".confidence", *confidence);
}

// Adds the rows of the task, which determine it completely.
void add_task(HashLines& lines, const Problem& problem) {
  for (std::size_t s = 0; s <= problem.via.size(); ++s) {
    const std::vector<TaskRow> rows = task_rows(problem.robot, problem.task, s);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const std::string name = fmt::format("task[{}][{}]", s, r);
      lines.add_text(name + ".kind", fmt::format("{} {}", rows[r].name, static_cast<int>(rows[r].kind)));
      lines.add(name + ".vector", rows[r].vector);
      lines.add(name + ".number", rows[r].number);
      lines.add(name + ".lower", rows[r].lower);
      lines.add(name + ".upper", rows[r].upper);
    }
  }
}

}  // namespace

std::string request_hash(const Problem& problem) {
  HashLines lines;
  lines.add_text("robot_hash", robot_hash(problem.robot));
  add_states(lines, problem);
  add_task(lines, problem);
  for (const QuantityInfo& quantity : Quantities::infos) {
    if (!quantity.of_first_version && !is_limited(quantity, problem.limits)) continue;
    const std::string name = fmt::format("limits.{}", quantity.name);
    quantity.of_tip ? lines.add(name, problem.limits.*quantity.of_tip)
                    : lines.add(name, problem.limits.*quantity.per_joint);
  }
  lines.add("duration.min", problem.duration.min);
  lines.add("duration.max", problem.duration.max);
  for (const TermInfo& term : Terms::infos) {
    if (!term.of_first_version && problem.weights.*term.weight == 0) continue;
    lines.add(fmt::format("objective.{}", term.name), problem.weights.*term.weight);
  }
  if (problem.release) lines.add("release", static_cast<double>(*problem.release));
  visit_settings(problem, [&](const char* key, const auto& value, bool in_hash) {
    if (in_hash) add_setting(lines, key, value);
  });
  if (problem.longest_sample_period != kLongestSamplePeriod) lines.add_text("sample_period", "asked for");
  // The uncertainty influences these plans, but is not part of the robot's hash.
  if (problem.robust || has_closed_loop(problem.weights)) {
    const Uncertainty uncertainty = uncertainty_of(problem.robot);
    for (std::size_t i = 0; i < uncertainty.names.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        lines.add(fmt::format("covariance.{}.{}", uncertainty.names[i], uncertainty.names[j]),
                  uncertainty.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
      }
    }
  }
  return lines.hash();
}

}  // namespace fjr
