#include "planner/service/solve_loop.h"

#include <fmt/format.h>

#include <chrono>
#include <exception>
#include <new>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "common/input_error.h"
#include "planner/library/learnt_plans.h"
#include "planner/plan.h"
#include "planner/protocol/messages.h"
#include "planner/request/request.h"
#include "planner/results/plan_json.h"
#include "planner/service/find_repetition.h"
#include "planner/service/frames.h"
#include "planner/service/progress_frame.h"
#include "planner/stop/stop_motion.h"

namespace fjr {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kProgressPause{50};

void send_done(int out, PlanStatus status, const std::string& reason) {
  write_frame(out, FrameKind::kDone, std::string(1, static_cast<char>(status)) + reason);
}

void send_rows(int out, const Trajectory& trajectory, const Certificate& certificate) {
  write_frame(out, FrameKind::kRows, as_payload(trajectory.samples));
  const LinkErrors errors{{certificate.tolerance, certificate.tolerance}, certificate.tracking.link_error};
  write_frame(out, FrameKind::kErrors, {reinterpret_cast<const char*>(&errors), sizeof errors});
}

PlanOptions with_progress(int out) {
  PlanOptions options;
  options.on_progress = [out, next = Clock::time_point{}](const Progress& progress) mutable {
    if (Clock::now() < next) return;
    next = Clock::now() + kProgressPause;
    write_frame(out, FrameKind::kProgress, to_payload(progress));
  };
  return options;
}

void solve(int out, const Problem& problem, const std::string& request, const WorkerSettings& settings,
           LearntPlans& learnt) {
  PlanOptions options = with_progress(out);
  options.jobs = static_cast<int>(settings.jobs);
  options.warm = learnt.nearest(problem);
  const Plan result = plan(problem, options);
  write_frame(out, FrameKind::kPlanJson, json_text(plan_json(problem, result)));
  if (result.status == PlanStatus::kCertified) send_rows(out, *result.trajectory, *result.certificate);
  send_done(out, result.status, result.reason);
  learnt.remember(problem, request, result);  // afterwards, so that the client need not wait for the disk
}

// The plan.json may have been written by another instance: whatever is wrong with it is told as a reason.
void find_repetition(int out, const Parameters& robot, const std::string& payload) try {
  const FoundRepetition found = find_repetition(robot, run_of_motion_from(payload));
  write_frame(out, FrameKind::kPlanJson, found.plan_json);
  write_frame(out, FrameKind::kRows, as_payload(found.rows));
  write_frame(out, FrameKind::kErrors, {reinterpret_cast<const char*>(&found.errors), sizeof found.errors});
  send_done(out, found.status, found.reason);
} catch (const std::exception& error) {
  send_done(out, PlanStatus::kNotConverged, fmt::format("cannot be learnt: {}", error.what()));
}

// Sends no stop motions if they cannot be found: then the executor looks for them itself, and tells the instant for
// which there is none.
void find_stops(int out, const Parameters& robot, const Trajectory& plan) {
  try {
    write_frame(out, FrameKind::kStops, as_payload(stop_motions(robot, plan, {})));
  } catch (const std::exception&) {
  }
  send_done(out, PlanStatus::kCertified, "");
}

// Sleeps instead of planning, to try out machines and networks.
void rehearse(int out, double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  send_done(out, PlanStatus::kNotConverged, fmt::format("rehearsed for {:g} s: nothing was planned", seconds));
}

void solve_or_refuse(int out, const std::string& name, const std::string& request, const Parameters& robot,
                     const WorkerSettings& settings, LearntPlans& learnt) {
  if (settings.rehearsal > 0) return rehearse(out, settings.rehearsal);
  try {
    solve(out, parse_request(request, name, robot), request, settings, learnt);
  } catch (const InputError& error) {
    send_done(out, PlanStatus::kBadInput, error.what());
  } catch (const std::bad_alloc&) {
    throw;                                 // with more memory another attempt may succeed
  } catch (const std::exception& error) {  // another attempt would end in the same way
    send_done(out, PlanStatus::kNotConverged, fmt::format("planning broke off: {}", error.what()));
  }
}

}  // namespace

void solve_requests(int in, int out, const WorkerSettings& settings) {
  const Parameters parameters = load_parameters(settings.robot);
  LearntPlans learnt(settings.warm_plans, settings.library);
  std::string name;
  while (const auto frame = read_frame(in)) {
    if (frame->kind == FrameKind::kName) {
      name = frame->payload;
      continue;
    }
    if (frame->kind == FrameKind::kFindStops) find_stops(out, parameters, {from_payload<Sample>(frame->payload), {}});
    if (frame->kind == FrameKind::kFindRepetition) find_repetition(out, parameters, frame->payload);
    if (frame->kind == FrameKind::kSolve) solve_or_refuse(out, name, frame->payload, parameters, settings, learnt);
    write_frame(out, FrameKind::kIdle, "");
  }
}

}  // namespace fjr
