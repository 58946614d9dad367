#include "planner/results/verification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "common/parallel.h"
#include "common/strict_yaml.h"
#include "model/uncertainty.h"
#include "planner/certificate/consistency.h"
#include "planner/certificate/proof/prove.h"
#include "planner/certificate/request_check.h"
#include "planner/certificate/residual.h"
#include "planner/certificate/robust/robustness.h"
#include "planner/request/request.h"
#include "planner/request/request_keys.h"
#include "planner/results/plan_json.h"
#include "planner/results/strict_json.h"

namespace fjr {
namespace {

constexpr double kSameTime = 1e-9;  // [s] for roundings

// Determines the payload: the given one, or else the robot's, or else that of plan.json, or else the file's.
void settle_payload(const std::optional<Payload>& given, const PlannedMotion& motion, Verification& v) {
  if (given) v.robot.payload = *given;
  const auto &of_file = v.header.payload, &of_plan = motion.payload;
  const auto& planned = of_plan ? of_plan : of_file;
  if (of_plan && of_file && *of_plan != *of_file) {
    v.contradictions.push_back(
        fmt::format("payload: the file says {}, but {} {}", text_of(*of_file), motion.told_by, text_of(*of_plan)));
  }
  if (!planned || *planned == v.robot.payload) return;
  if (!given && v.robot.payload == Payload{}) {
    v.robot.payload = *planned;
  } else {
    v.contradictions.push_back(fmt::format("payload: it was planned with {}, but {} {}", text_of(*planned),
                                           given ? "--payload says" : "the robot has", text_of(v.robot.payload)));
  }
}

void tighten(Verification& v) {
  for (const LimitInHeader& header : v.header.limits) {
    double& limit = kLimitNames[header.index].in(v.limits);
    if (header.value > limit) {
      v.contradictions.push_back(fmt::format("{}: the file says {} {}, but the robot's {} {} hold", header.key(),
                                             header.value, header.unit(), limit, header.unit()));
    }
    limit = std::min(limit, header.value);
  }
}

// Adds a contradiction if the trajectory was planned for a robot that differs in more than the payload.
void compare_robots(const Trajectory& trajectory, Verification& v) {
  const auto planned_for = trajectory.metadata.find("robot_hash");
  const std::string hash = robot_hash(v.robot);
  if (planned_for == trajectory.metadata.end() || planned_for->second == hash) return;
  Parameters as_planned = v.robot;
  if (v.header.payload) as_planned.payload = *v.header.payload;
  if (robot_hash(as_planned) == planned_for->second) return;
  v.contradictions.push_back(fmt::format("it was planned for another robot (robot_hash {}, this robot's is {}){}",
                                         planned_for->second, hash, v.header.payload ? "" : " or payload"));
}

// Adds a contradiction for each value of the robot that plan.json says otherwise, if it is meant to be the same robot.
void compare_values(const PlannedMotion& planned, Verification& v) {
  if (planned.robot_hash != robot_hash(v.robot)) return;  // compare_requests() and compare_robots() tell of that
  visit_parameters(v.robot, [&](const char* section, const char* name, const char* unit, const Joints<double>& values) {
    const std::string key = fmt::format("{}.{}", section, name);
    const auto said = planned.robot_values.find(key);
    if (said == planned.robot_values.end() || said->second == values) return;
    v.contradictions.push_back(fmt::format("plan.json: robot.{} is [{}, {}], but the robot's [{}, {}] {} hold", key,
                                           said->second[0], said->second[1], values[0], values[1], unit));
  });
}

// Adds a contradiction if the rows were planned for another request than `planned` tells of, or if plan.json belongs to
// a plan that is not certified.
void compare_requests(const Trajectory& trajectory, const PlannedMotion& planned, Verification& v) {
  const bool executable = plan_status(planned.status) == PlanStatus::kCertified || planned.status == kLearntStatus;
  if (!planned.status.empty() && !executable) {
    v.contradictions.push_back(fmt::format("plan.json says that the plan is {}", shown(planned.status)));
  }
  if (executable && planned.verdict == "failed") {
    v.contradictions.push_back("plan.json says that the certificate failed, and that the plan is certified");
  }
  const auto robot = trajectory.metadata.find("robot_hash");
  if (!planned.robot_hash.empty() && robot != trajectory.metadata.end() && robot->second != planned.robot_hash) {
    v.contradictions.push_back(fmt::format("it was planned for another robot (robot_hash {}, that of plan.json is {})",
                                           robot->second, planned.robot_hash));
  }
  const auto hash = trajectory.metadata.find("request_hash");
  if (planned.request_hash.empty() || hash == trajectory.metadata.end() || hash->second == planned.request_hash) return;
  v.contradictions.push_back(fmt::format("it was planned for another request (request_hash {}, that of {} is {})",
                                         hash->second, planned.told_by, planned.request_hash));
}

// Returns whether the file contains as many rows as its header says; nothing if the header does not say.
std::optional<bool> is_complete(const Trajectory& trajectory) {
  if (!trajectory.metadata.contains("rows")) return std::nullopt;
  return !rows_missing(trajectory);
}

// Reports a truncated file: its rows may still be exact, but they are not the planned motion.
void check_completeness(const Trajectory& trajectory, Verification& v) {
  v.complete = is_complete(trajectory);
  if (v.complete.value_or(true)) return;
  v.certificate.certified = false;
  v.certificate.failures.push_back(*rows_missing(trajectory));
}

void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& task) {
  for_each_index(count, static_cast<int>(std::max(1U, std::thread::hardware_concurrency())), task);
}

// Returns the one of the alternative goals to which the motion comes nearest.
const Goal& nearest_goal(const std::vector<Goal>& goals, const Joints<double>& q) {
  const auto away = [&q](const Goal& goal) {
    double most = 0;
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (!goal.free[j]) most = std::max(most, std::abs(goal.q[j] - q[j]));
    }
    return most;
  };
  return *std::min_element(goals.begin(), goals.end(), [&](const Goal& a, const Goal& b) { return away(a) < away(b); });
}

void check_against_planned(const PlannedMotion& planned, const Trajectory& trajectory, Verification& v) {
  if (planned.ends.empty()) return;  // no plan is known
  if (trajectory.start_time() != 0) {
    v.certificate.certified = false;
    v.certificate.failures.push_back(
        fmt::format("the rows begin at {} s, and the motion of {} at 0 s", trajectory.start_time(), planned.told_by));
  }
  if (std::abs(trajectory.end_time() - planned.ends.back()) > kSameTime) {
    v.certificate.certified = false;
    v.certificate.failures.push_back(fmt::format("the rows end at {} s, and the motion of {} at {} s",
                                                 trajectory.end_time(), planned.told_by, planned.ends.back()));
  }
  if (!planned.start || planned.goals.empty()) {
    v.contradictions.push_back(planned.told_by +
                               " does not say from where to where the motion was to go: that is not checked");
    return check_against_task(v.robot, planned.task, planned.ends, trajectory, v.certificate);
  }
  Problem asked;
  asked.robot = v.robot;
  asked.start = *planned.start;
  asked.goal = nearest_goal(planned.goals, trajectory.samples.back().state.q);
  asked.duration = planned.duration;
  asked.via = planned.via;
  asked.task = planned.task;
  check_against_request(asked, planned.ends, trajectory, v.certificate);
}

// Tightens the limits to those of plan.json, even if the file's header does not contain them.
void tighten_as_planned(const PlannedMotion& planned, Verification& v) {
  for (const LimitName& name : kLimitNames) {
    const double asked = name.in(planned.limits);
    double& limit = name.in(v.limits);
    if (!(asked < limit)) continue;
    v.contradictions.push_back("the file " + leaves_out(name, asked));
    limit = asked;
  }
}

}  // namespace

VerifyOptions as_asked_by(const Problem& request, PlannedMotion of_plan, const Trajectory& trajectory) {
  VerifyOptions options;
  options.payload = request.robot.payload;
  options.planned = requested_motion(request, std::move(of_plan), trajectory);
  return options;
}

Verification verify(const Trajectory& trajectory, const std::string& source, const Parameters& robot,
                    const VerifyOptions& options) {
  Verification v{robot, {}, planned_with(trajectory.metadata, source), {}, {}, {}};
  settle_payload(options.payload, options.planned, v);
  v.limits = Limits::of(v.robot);
  tighten(v);
  tighten_as_planned(options.planned, v);
  compare_robots(trajectory, v);
  compare_requests(trajectory, options.planned, v);
  compare_values(options.planned, v);
  v.certificate = certify(v.robot, v.limits, trajectory);
  const bool well_formed = !malformed(trajectory);  // otherwise that is the reason, and there are no rows to go by
  if (well_formed) check_against_planned(options.planned, trajectory, v);
  const TaskOfMotion task = TaskOfMotion::of(v.robot, options.planned.task, options.planned.ends);
  if (options.proven || options.planned.proven)
    demand_proof(v.robot, v.limits, task, trajectory, v.certificate, on_all_cores);
  std::optional<double> robust = options.robust;  // or what the request asked for, if that is more
  if (options.planned.robust > robust) {
    if (uncertainty_of(v.robot).none()) {
      v.contradictions.push_back(
          "margins for uncertain arms were asked for, and this robot has no standard errors: they "
          "are not checked");
    } else {
      robust = options.planned.robust;
    }
  }
  if (robust && well_formed) {
    demand_robustness(v.robot, v.limits, task, trajectory, *robust, v.certificate, on_all_cores);
  }
  check_completeness(trajectory, v);
  if (!v.certificate.certified) {  // the reason behind the others
    v.certificate.failures.insert(v.certificate.failures.begin(), v.contradictions.begin(), v.contradictions.end());
  }
  return v;
}

nlohmann::ordered_json verification_json(const Trajectory& trajectory, const Verification& v) {
  nlohmann::ordered_json json = certificate_json(v.certificate);
  json["complete"] = v.complete ? nlohmann::ordered_json(*v.complete) : nlohmann::ordered_json(nullptr);
  json["starts_at_rest"] = is_at_rest(v.robot, trajectory.samples.front());
  json["ends_at_rest"] = is_at_rest(v.robot, trajectory.samples.back());
  json["robot_hash"] = robot_hash(v.robot);
  json["payload"] = {{"mass", v.robot.payload.mass}, {"inertia", v.robot.payload.inertia}};
  json["contradictions"] = v.contradictions;
  return json;
}

}  // namespace fjr
