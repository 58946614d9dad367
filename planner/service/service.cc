#include "planner/service/service.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "model/input_error.h"
#include "planner/problem/problem.h"
#include "planner/service/memory.h"
#include "planner/service/progress_frame.h"

namespace fjr {
namespace {

constexpr std::chrono::milliseconds kHeartbeat{200};
constexpr std::chrono::milliseconds kFarewell{400};  // for clients to take their last replies
constexpr std::size_t kRemembered = 256;             // replies kept for repeated requests
constexpr std::size_t kRememberedBytes = 32 << 20;

double seconds(Job::Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

Job::Clock::duration duration_of(double seconds) {
  return std::chrono::duration_cast<Job::Clock::duration>(std::chrono::duration<double>(seconds));
}

// What the certificate allowed, and what it predicts for the executor.
void say_errors(TrajectoryOrder& order, const std::string& plan_json) {
  const auto certificate = nlohmann::json::parse(plan_json).at("certificate");
  order.certified_error.fill(certificate.at("tolerance_rad").get<double>());
  order.predicted_error = certificate.at("tracking").at("link_error_rad").get<Pair<double>>();
}

}  // namespace

Service::Service(const ServiceConfig& config)
    : config_(config),
      robot_hash_(robot_hash(load_parameters(config.robot))),
      port_(config.domain),
      queue_(config.queue),
      cache_(kRemembered, kRememberedBytes),
      solvers_(config.workers) {
  start_workers();
}

void Service::stop() {
  stopping_ = true;
  port_.wake();
}

void Service::run() {
  spdlog::info("serving instance={} domain={} workers={} queue={} robot={}", config_.instance, config_.domain,
               config_.workers, config_.queue, robot_hash_.substr(0, 12));
  while (!stopping_) {
    for (const RequestId& id : port_.take_cancels()) cancel(id);
    for (Order& order : port_.take_requests()) admit(std::move(order));
    for (Event& event : take_events()) handle(std::move(event));
    expire();
    give_work();
    if (Clock::now() >= next_heartbeat_) heartbeat();
    port_.wait(time_to_next());
  }
  answer_all_in_flight();
}

// ---- what comes in ----

void Service::admit(Order order) {
  if (repeat(order)) return;
  tally_.received();
  if (queue_.full()) {
    // Not remembered: the same request may find room later.
    return reject(order, {Reason::kQueueFull, "", fmt::format("{} requests wait already", queue_.size())}, false);
  }
  Job job;
  if (auto refusal = refusal_of(order, job.request_hash)) return reject(order, std::move(*refusal), true);
  job.arrived = Clock::now();
  job.deadline = job.arrived + duration_of(order.budget > 0 ? order.budget : config_.budget);
  spdlog::info("accepted id={} name={} priority={} queued={}", text(order.id), order.name, order.priority,
               queue_.size());
  send(reply_to(order, ReplyState::kAccepted));
  job.order = std::move(order);
  queue_.push(std::move(job));
}

std::optional<Refusal> Service::refusal_of(const Order& order, std::string& request_hash) const {
  if (order.refusal) return order.refusal;
  if (order.budget > config_.longest_budget) {
    return Refusal{Reason::kBadInput, "budget",
                   fmt::format("{} s is above {} s", order.budget, config_.longest_budget)};
  }
  if (!order.robot_hash.empty() && order.robot_hash != robot_hash_) {
    return Refusal{Reason::kWrongRobot, "robot", "the service plans for the robot with hash " + robot_hash_};
  }
  try {
    const Problem problem = parse_request(order.yaml, order.name, {}, config_.robot);
    request_hash = problem.request_hash;
    if (order.execute && !problem.start_at_rest) {
      return Refusal{Reason::kBadInput, "start", "must be at rest to be executed"};
    }
    if (order.execute && !problem.goal.at_rest) {
      return Refusal{Reason::kBadInput, "goal", "must be at rest to be executed"};
    }
    return std::nullopt;
  } catch (const InputError& error) {
    const bool later = error.problem().find("not supported by this version") != std::string::npos;
    return Refusal{later ? Reason::kUnsupported : Reason::kBadInput, error.field(), error.problem()};
  }
}

// A client that hears nothing asks again: it gets the reply it missed, or hears that its request is in hand.
bool Service::repeat(const Order& order) {
  if (const SharedReply reply = cache_.find(order.id)) {
    tally_.duplicate();
    send(*reply);
    return true;
  }
  if (!in_hand(order.id)) return false;
  tally_.duplicate();
  send(reply_to(order, ReplyState::kAccepted));
  return true;
}

bool Service::in_hand(const RequestId& id) const {
  return queue_.contains(id) || std::any_of(solvers_.begin(), solvers_.end(), [&](const Solver& solver) {
           return solver.job && solver.job->order.id == id;
         });
}

void Service::cancel(const RequestId& id) {
  if (const SharedReply reply = cache_.find(id)) return send(*reply);
  if (const auto job = queue_.remove_if([&](const Job& waiting) { return waiting.order.id == id; })) {
    return give_up(*job, ReplyState::kCancelled, Reason::kCancelled, "cancelled while it waited");
  }
  for (Solver& solver : solvers_) {
    if (!solver.job || solver.job->order.id != id) continue;
    give_up(*solver.job, ReplyState::kCancelled, Reason::kCancelled, "cancelled while it was solved");
    return replace(solver);
  }
  // Perhaps it has overtaken its request, which will then find this.
  Job unknown;
  unknown.order.id = id;
  unknown.arrived = Clock::now();
  give_up(unknown, ReplyState::kCancelled, Reason::kCancelled, "cancelled before it arrived");
}

// ---- workers ----

std::vector<Service::Event> Service::take_events() {
  const std::lock_guard lock(events_mutex_);
  return std::exchange(events_, {});
}

void Service::start_workers() {
  for (Solver& solver : solvers_) {
    if (solver.worker) continue;
    const std::uint64_t serial = next_serial_++;
    solver.serial = serial;
    solver.worker = std::make_unique<Worker>(config_.robot, [this, serial](std::optional<Frame> frame) {
      {
        const std::lock_guard lock(events_mutex_);
        events_.push_back({serial, std::move(frame)});
      }
      port_.wake();
    });
  }
}

// What it was doing is over; its later words are of a serial nobody knows.
void Service::replace(Solver& solver) {
  solver = Solver{};
  start_workers();
}

void Service::handle(Event event) {
  const auto found = std::find_if(solvers_.begin(), solvers_.end(),
                                  [&](const Solver& solver) { return solver.worker && solver.serial == event.worker; });
  if (found == solvers_.end()) return;
  event.frame ? take_frame(*found, std::move(*event.frame)) : lose(*found);
}

void Service::take_frame(Solver& solver, Frame frame) {
  if (!solver.job) return;
  switch (frame.kind) {
    case FrameKind::kProgress:
      report_progress(solver, frame.payload);
      break;
    case FrameKind::kPlanJson:
      solver.result.plan_json = std::move(frame.payload);
      break;
    case FrameKind::kRows:
      solver.result.rows.resize(frame.payload.size() / sizeof(Sample));
      std::memcpy(static_cast<void*>(solver.result.rows.data()), frame.payload.data(),
                  solver.result.rows.size() * sizeof(Sample));
      break;
    case FrameKind::kDone: {
      const auto status = static_cast<PlanStatus>(frame.payload.at(0));
      Reply reply = reply_to(solver.job->order, state_of(status), {reason_of(status), "", frame.payload.substr(1)});
      reply.plan_json = std::move(solver.result.plan_json);
      if (status == PlanStatus::kCertified) reply.rows = std::move(solver.result.rows);
      finish(*solver.job, std::move(reply));
      solver.job.reset();
      solver.result = {};
      break;
    }
    case FrameKind::kName:
    case FrameKind::kSolve:
      break;
  }
}

// It is started again with the next heartbeat: one that cannot start at all must not keep the service busy.
void Service::lose(Solver& solver) {
  tally_.worker_lost();
  spdlog::error("worker lost pid={} solving={}", solver.worker->pid(),
                solver.job ? text(solver.job->order.id) : "none");
  if (solver.job)
    give_up(*solver.job, ReplyState::kFailed, Reason::kWorkerLost, "the solving process ended unexpectedly");
  solver = Solver{};
}

void Service::report_progress(const Solver& solver, const std::string& payload) {
  const auto progress = progress_from(payload);
  if (progress)
    port_.send(ProgressReport{solver.job->order.id, 0, *progress, seconds(Clock::now() - solver.job->arrived)});
}

void Service::give_work() {
  for (Solver& solver : solvers_) {
    if (queue_.empty()) return;
    if (!solver.worker || solver.job) continue;
    solver.job = queue_.pop();
    solver.job->started = Clock::now();
    solver.result = {};
    if (!solver.worker->solve(solver.job->order.name, solver.job->order.yaml)) lose(solver);
  }
}

// ---- time ----

void Service::expire() {
  const auto now = Clock::now();
  const auto overdue = [&](const Job& job) { return job.deadline <= now; };
  while (const auto job = queue_.remove_if(overdue)) {
    give_up(*job, ReplyState::kExpired, Reason::kBudget, "the time budget was used up while it waited");
  }
  for (Solver& solver : solvers_) {
    if (!solver.job || !overdue(*solver.job)) continue;
    give_up(*solver.job, ReplyState::kExpired, Reason::kBudget, "the time budget was used up while it was solved");
    replace(solver);
  }
}

std::chrono::nanoseconds Service::time_to_next() const {
  Clock::time_point next = next_heartbeat_;
  for (const Job& job : queue_.jobs()) next = std::min(next, job.deadline);
  for (const Solver& solver : solvers_) {
    if (solver.job) next = std::min(next, solver.job->deadline);
  }
  return std::max(Clock::duration::zero(), next - Clock::now());
}

void Service::heartbeat() {
  next_heartbeat_ = Clock::now() + kHeartbeat;
  start_workers();
  ServiceStatus status = tally_.status();
  status.instance = config_.instance;
  status.robot_hash = robot_hash_;
  status.version = FJR_VERSION;
  status.uptime = seconds(Clock::now() - began_);
  status.queued = static_cast<std::uint32_t>(queue_.size());
  status.queue_capacity = static_cast<std::uint32_t>(queue_.capacity());
  status.workers = static_cast<std::uint32_t>(solvers_.size());
  status.memory = resident_bytes(::getpid());
  for (const Solver& solver : solvers_) {
    if (solver.job) ++status.solving;
    if (solver.worker) status.memory += resident_bytes(solver.worker->pid());
  }
  port_.send(status);
}

// ---- what goes out ----

Reply Service::reply_to(const Order& order, ReplyState state, Refusal why) const {
  Reply reply;
  reply.id = order.id;
  reply.state = state;
  reply.why = std::move(why);
  reply.robot_hash = robot_hash_;
  reply.version = FJR_VERSION;
  return reply;
}

void Service::finish(const Job& job, Reply reply) {
  const auto now = Clock::now();
  const bool started = job.started != Clock::time_point{};
  reply.request_hash = job.request_hash;
  reply.solve_time = started ? seconds(now - job.started) : 0;
  reply.wait_time = seconds((started ? job.started : now) - job.arrived);
  const auto shared = std::make_shared<const Reply>(std::move(reply));
  cache_.add(shared);
  tally_.count(*shared, seconds(now - job.arrived));
  send(*shared);
  if (job.order.execute && shared->state == ReplyState::kSolved) publish(*shared);
  spdlog::info("finished id={} state={} wait={:.3f} solve={:.3f} {}", text(shared->id), name(shared->state),
               shared->wait_time, shared->solve_time, shared->why.sentence);
}

void Service::give_up(const Job& job, ReplyState state, Reason reason, const std::string& sentence) {
  finish(job, reply_to(job.order, state, {reason, "", sentence}));
}

void Service::reject(const Order& order, Refusal why, bool remember) {
  const auto reply = std::make_shared<const Reply>(reply_to(order, ReplyState::kRejected, std::move(why)));
  if (remember) cache_.add(reply);
  tally_.count(*reply, 0);
  send(*reply);
  if (log_refusals_.allows()) {
    spdlog::info("rejected id={} field={} {}", text(order.id), reply->why.field, reply->why.sentence);
  }
}

// Only a certified trajectory has rows. A repeated request is answered again but never published again.
void Service::publish(const Reply& reply) {
  TrajectoryOrder order;
  order.robot_id = config_.robot_id;
  order.id = reply.id;
  order.epoch = 1;
  order.published =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  order.robot_hash = reply.robot_hash;
  order.request_hash = reply.request_hash;
  order.certified = reply.state == ReplyState::kSolved;
  order.ends_at_rest = true;  // seen to at admission
  say_errors(order, reply.plan_json);
  order.rows = reply.rows;
  if (!port_.send(order)) spdlog::error("not published id={}: the executor is too slow", text(reply.id));
}

void Service::send(const Reply& reply) {
  if (!port_.send(reply) && log_slow_clients_.allows()) {
    spdlog::warn("slow client id={}: it will have to ask again", text(reply.id));
  }
}

void Service::answer_all_in_flight() {
  const auto farewell = [this](const Job& job) {
    give_up(job, ReplyState::kCancelled, Reason::kShuttingDown, "the service is shutting down; send the request again");
  };
  for (Solver& solver : solvers_) {
    if (solver.job) farewell(*solver.job);
  }
  while (!queue_.empty()) farewell(queue_.pop());
  port_.flush(kFarewell);
  spdlog::info("stopped");
}

}  // namespace fjr
