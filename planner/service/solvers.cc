#include "planner/service/solvers.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "planner/service/admission.h"
#include "planner/service/memory.h"
#include "planner/service/progress_frame.h"

namespace fjr {

Solvers::Solvers(std::size_t count, WorkerSettings settings, std::function<void()> wake, std::shared_ptr<Turns> turns)
    : settings_(std::move(settings)), wake_(std::move(wake)), turn_(std::move(turns), wake_), solvers_(count) {
  replace_missing();
}

void Solvers::replace_missing() {
  for (Solver& solver : solvers_) {
    if (!solver.worker) start(solver);
  }
}

void Solvers::start(Solver& solver) {
  const std::uint64_t serial = next_serial_++;
  solver = {};
  solver.serial = serial;
  const auto listen = [this, serial](std::optional<Frame> frame) {
    // The parts of a result can wait for its end, which follows at once.
    const bool news = !frame || frame->kind == FrameKind::kDone || frame->kind == FrameKind::kIdle ||
                      frame->kind == FrameKind::kProgress;
    {
      const std::lock_guard lock(events_mutex_);
      events_.push_back({serial, std::move(frame)});
    }
    if (news) wake_();
  };
  try {
    solver.worker = std::make_unique<Worker>(settings_, listen);
  } catch (const std::system_error& error) {  // out of processes or descriptors: tried again with the next heartbeat
    if (log_start_.allows()) spdlog::error("{}", error.what());
  }
}

std::size_t Solvers::free() const {
  return static_cast<std::size_t>(
      std::count_if(solvers_.begin(), solvers_.end(), [](const Solver& s) { return s.idle(); }));
}

std::size_t Solvers::without_job() const {
  return static_cast<std::size_t>(
      std::count_if(solvers_.begin(), solvers_.end(), [](const Solver& s) { return s.worker && !s.job; }));
}

bool Solvers::may_solve() {
  if (free() > 0) return turn_.ask();
  turn_.withdraw();  // others need not wait for one of these
  return false;
}

void Solvers::withdraw() { turn_.withdraw(); }

double Solvers::load() const {
  return solvers_.empty() ? 1 : static_cast<double>(jobs().size()) / static_cast<double>(solvers_.size());
}

void Solvers::solve(Job job) {
  const auto solver = std::find_if(solvers_.begin(), solvers_.end(), [](const Solver& s) { return s.idle(); });
  if (solver == solvers_.end()) throw std::logic_error("Solvers::solve() without an idle one");
  turn_.begin();
  job.started = Job::Clock::now();
  solver->job = std::move(job);
  solver->result = {};
  solver->planned = false;
  if (!solver->job->planned) {
    ++solver->tasks;
    return solver->worker->solve(solver->job->order.name, solver->job->document);
  }
  if (const SharedRun& run = solver->job->run) {
    const Reply& executed = *solver->job->planned;
    ++solver->tasks;
    return solver->worker->find_repetition({to_text(executed.motion), to_text(executed.id), executed.plan_json,
                                            executed.rows, run->rows, run->missed_ticks,
                                            solver->job->refused_fraction});
  }
  const Reply& planned = *solver->job->planned;
  solver->result.plan_json = planned.plan_json;
  solver->result.errors = planned.errors;
  solver->result.rows = planned.rows;
  find_stops(*solver);
}

void Solvers::find_stops(Solver& solver) {
  solver.planned = true;
  ++solver.tasks;
  solver.worker->find_stops(solver.result.rows);
}

// Stops a solving process by replacing it. Messages that it still sends are ignored, because they have an old serial.
Job Solvers::stop(Solver& solver) {
  Job job = std::move(*solver.job);
  turn_.end();
  start(solver);
  return job;
}

Solvers::News Solvers::take_news() {
  std::vector<Event> events;
  {
    const std::lock_guard lock(events_mutex_);
    events.swap(events_);
  }
  News news;
  for (Event& event : events) {
    const auto found = std::find_if(solvers_.begin(), solvers_.end(),
                                    [&](const Solver& s) { return s.worker && s.serial == event.worker; });
    if (found == solvers_.end()) continue;
    event.frame ? take_frame(*found, std::move(*event.frame), news) : lose(*found, news);
  }
  return news;
}

void Solvers::take_frame(Solver& solver, Frame frame, News& news) {
  if (frame.kind == FrameKind::kIdle) --solver.tasks;
  if (!solver.job) return;
  switch (frame.kind) {
    case FrameKind::kProgress:
      return report_progress(*solver.job, frame.payload, news);
    case FrameKind::kPlanJson:
      solver.result.plan_json = std::move(frame.payload);
      return;
    case FrameKind::kRows:
      solver.result.rows = from_payload<Sample>(frame.payload);
      return;
    case FrameKind::kStops:
      solver.result.stops = from_payload<StopMotion>(frame.payload);
      return;
    case FrameKind::kErrors:
      if (frame.payload.size() == sizeof(LinkErrors)) {
        std::memcpy(&solver.result.errors, frame.payload.data(), sizeof(LinkErrors));
      }
      return;
    case FrameKind::kDone:
      return conclude(solver, frame.payload, news);
    case FrameKind::kIdle:
    case FrameKind::kName:
    case FrameKind::kSolve:
    case FrameKind::kFindStops:
    case FrameKind::kFindRepetition:
      return;
  }
}

void Solvers::report_progress(const Job& job, const std::string& payload, News& news) const {
  const auto progress = progress_from(payload);
  const std::chrono::duration<double> elapsed = Job::Clock::now() - job.arrived;
  if (progress) news.progress.push_back({job.order.id, 0, *progress, elapsed.count()});
}

void Solvers::conclude(Solver& solver, const std::string& payload, News& news) {
  if (payload.empty()) return;
  const auto status = static_cast<PlanStatus>(payload.front());
  if (status == PlanStatus::kCertified && executes(solver.job->order) && !solver.planned) return find_stops(solver);
  SolveOutcome outcome = std::exchange(solver.result, {});
  outcome.job = std::move(*std::exchange(solver.job, std::nullopt));
  turn_.end();
  outcome.state = state_of(status);
  outcome.why = {reason_of(status), "", payload.substr(1)};
  if (status != PlanStatus::kCertified) outcome.rows.clear();
  news.outcomes.push_back(std::move(outcome));
}

// Handles a process that ended unexpectedly. It is restarted with the next heartbeat and not at once, so that a process
// that cannot start at all does not keep the service busy.
void Solvers::lose(Solver& solver, News& news) {
  ++lost_;
  spdlog::error("worker lost pid={} solving={}", solver.worker->pid(),
                solver.job ? text(solver.job->order.id) : "none");
  if (solver.job) {
    turn_.end();
    ++solver.job->lost;
    news.lost.push_back(std::move(*solver.job));
  }
  solver = Solver{};
}

std::vector<const Job*> Solvers::jobs() const {
  std::vector<const Job*> jobs;
  for (const Solver& solver : solvers_) {
    if (solver.job) jobs.push_back(&*solver.job);
  }
  return jobs;
}

std::uint64_t Solvers::memory() const {
  std::uint64_t bytes = 0;
  for (const Solver& solver : solvers_) {
    if (solver.worker) bytes += resident_bytes(solver.worker->pid());
  }
  return bytes;
}

}  // namespace fjr
