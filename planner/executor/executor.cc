#include "planner/executor/executor.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>

#include "planner/executor/execution_log.h"

namespace fjr {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kPatience{5000};  // wait for the arm to come to rest at the end
constexpr std::chrono::milliseconds kFarewell{200};   // wait for readers to take the last result
constexpr std::chrono::milliseconds kLooking{500};    // wait for other executors: discovery takes 13 ms, a lease 300 ms
constexpr std::chrono::milliseconds kBeside{500};     // another executor counts as present this long after a message
constexpr std::size_t kConsidered = 1024;             // remembered trajectories
constexpr std::size_t kUnsentRuns = 4;                // runs that may wait for a slow reader
constexpr std::chrono::milliseconds kSendAgain{500};
constexpr std::size_t kUnsigned = 64;                // trajectories that may wait for a signed copy
constexpr std::chrono::milliseconds kForACopy{250};  // wait for that copy

std::filesystem::path history_file(const ExecutorConfig& config) {
  const std::filesystem::path folder = config.state.empty() ? default_state_folder() : config.state;
  std::filesystem::create_directories(folder);
  std::string name = fmt::format("executor-{}-{}", config.network.domain, config.robot_id);
  std::replace(name.begin(), name.end(), '/', '%');  // a robot_id may contain what separates folders
  return folder / name;
}

}  // namespace

Executor::Executor(const ExecutorConfig& config, const Parameters& robot, Arm& arm)
    : config_(config),
      robot_(robot),
      port_(dds::guarded_participant(config.network), config.robot_id),
      history_(history_file(config)),
      control_(robot, arm),
      drift_watch_(robot) {
  if (!config.network.security.empty()) signatures_.emplace(config.network.security);
  situation_.robot_hash = robot_hash(robot_);
  situation_.started = clock_.now();
  situation_.oldest = config.oldest;
  situation_.epoch = history_.epoch();
  if (!config.logs.empty()) std::filesystem::create_directories(config.logs);
}

void Executor::run() {
  claim();
  std::exception_ptr failure, tick_failure;
  std::thread ticking([this, &tick_failure] {
    try {
      keep_ticking();
    } catch (...) {
      tick_failure = std::current_exception();
      over_ = true;
    }
  });
  try {
    while (!stopping_ && !over_ && !superseded_) serve();
    if (!over_) come_to_rest();
  } catch (...) {  // results can no longer be published, but the arm still comes to rest
    failure = std::current_exception();
    if (!over_) stop_silently();
  }
  over_ = true;
  if (preparing_) preparing_->unwanted.request_stop();  // the destructor waits for its thread
  ticking.join();
  if (tick_failure) std::rethrow_exception(tick_failure);
  if (failure) std::rethrow_exception(failure);
  if (superseded_) throw std::runtime_error(*superseded_);
  report_lateness();
}

// ---- other executors of the robot ----

// Makes sure that no other executor of this robot runs, before anything is commanded or reported.
void Executor::claim() {
  self_ = port_.self();
  const auto refuse_if = [this](const std::vector<Claimant>& others) {
    for (const Claimant& other : others) {
      if (!gives_way(self_, other)) continue;
      throw std::runtime_error(
          fmt::format("another executor of robot '{}' is {} on DDS domain {}: end it first, or give "
                      "this one another --robot-id",
                      config_.robot_id, other.established ? "running" : "starting", config_.network.domain));
    }
  };
  for (const auto began = Clock::now(); Clock::now() - began < kLooking && !stopping_;) {
    refuse_if(port_.take_reporting());
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  refuse_if(port_.announced());
  self_.established = true;
}

// Looks for other executors again and again, because discovery may have been late or interrupted at the start.
void Executor::look_for_others() {
  self_.moved = self_.moved || latest_.trajectory_id != RequestId{};
  for (const Claimant& other : port_.take_reporting()) {
    if (Clock::now() - other_heard_ > kBeside) {
      spdlog::error("another executor of robot={} reports, too", config_.robot_id);
    }
    other_heard_ = Clock::now();
    if (!gives_way(self_, other)) continue;
    superseded_ = fmt::format("another executor of robot '{}' is running on DDS domain {}, {}: this one gives way",
                              config_.robot_id, config_.network.domain,
                              other.moved && !self_.moved ? "and has moved the arm" : "and its GUID is smaller");
  }
}

// ---- the control tick ----

void Executor::keep_ticking() {
  const std::string refused = config_.fast ? "" : become_realtime(config_.priority);
  if (!refused.empty()) spdlog::warn("the control tick is not real-time: {}", refused);
  Metronome metronome(kTick);
  for (int ticks = 1; !over_;) {
    control_.tick(ticks);
    if (config_.fast && control_.moving()) {
      metronome.restart();
      ticks = 1;
    } else {
      ticks = metronome.wait(lateness_);
    }
  }
}

// ---- everything else ----

void Executor::serve() {
  const bool new_here = !ticking_;
  serve_without_orders();
  if (!ticking_) return;
  if (new_here) {
    spdlog::info("executing for robot={} domain={} at q=({:.4f}, {:.4f})", config_.robot_id, config_.network.domain,
                 latest_.q[0], latest_.q[1]);
  }
  take_orders();
}

void Executor::serve_without_orders() {
  port_.wait(std::chrono::milliseconds(1));
  publish_states();
  conclude_finished();
  publish_unsent_runs();
  conclude_preparation();
  report_drift();
  look_for_others();
  obey();
}

void Executor::obey() {
  for (const ExecutorOrder& order : port_.take_commands()) {
    if (order.robot_id != config_.robot_id) continue;
    spdlog::info("{} commanded id={}", order.command == ExecutorCommand::kStop ? "stop" : "hold", text(order.id));
    order.command == ExecutorCommand::kStop ? control_.stop() : control_.hold();
    situation_.halted = clock_.now();
    if (preparing_) preparing_->unwanted.request_stop();
  }
}

void Executor::take_orders() {
  for (TrajectoryOrder& order : port_.take_trajectories()) {
    if (order.robot_id == config_.robot_id) consider(std::move(order));
  }
  refuse_unsigned();
}

void Executor::consider(TrajectoryOrder order) {
  if (!trusts(order) || considered(order.id)) return;
  note_considered(order.id);
  if (const History::Entry* entry = history_.find(order.id)) return report_again(*entry);
  look_at_arm();
  situation_.now = clock_.now();
  if (preparing_) situation_.mode = ExecutorMode::kPreparing;
  if (const auto refusal = refusal_now(order)) return refuse(order.id, *refusal);
  begin_to_prepare(std::move(order));
}

bool Executor::considered(const RequestId& id) const {
  return std::find(considered_.begin(), considered_.end(), id) != considered_.end();
}

void Executor::note_considered(const RequestId& id) {
  considered_.push_back(id);
  if (considered_.size() > kConsidered) considered_.pop_front();
}

// The signature is checked before the id is used: otherwise a forged copy under the same id could have the genuine
// trajectory refused, whichever of them comes first.
bool Executor::trusts(const TrajectoryOrder& order) {
  if (!signatures_) return true;
  const auto of_this = [&](const Unsigned& other) { return other.id == order.id; };
  const auto fault = signatures_->fault_of(signed_bytes(order), order.signature, kPublisherRole);
  if (!fault) {
    for (const Unsigned& copy : unsigned_) {
      if (of_this(copy)) spdlog::warn("left out a copy of id={}: {}", text(copy.id), copy.fault);
    }
    std::erase_if(unsigned_, of_this);
    return true;
  }
  if (considered(order.id)) {  // the copy that came first has got the result
    spdlog::warn("left out a copy of id={}: {}", text(order.id), *fault);
  } else if (std::none_of(unsigned_.begin(), unsigned_.end(), of_this)) {
    unsigned_.push_back({order.id, *fault, Clock::now() + kForACopy});
  }
  return false;
}

// Refuses trajectories for which no validly signed copy came in time. They are not run later, even if a signed copy
// comes.
void Executor::refuse_unsigned() {
  while (!unsigned_.empty() && (Clock::now() >= unsigned_.front().refused_at || unsigned_.size() > kUnsigned)) {
    note_considered(unsigned_.front().id);
    refuse(unsigned_.front().id, {ResultCode::kInvalidGoal, unsigned_.front().fault});
    unsigned_.pop_front();
  }
}

void Executor::look_at_arm() {
  situation_.q = latest_.q;
  situation_.rest_theta = rest_at(robot_, latest_.q).theta;
  situation_.theta = latest_.theta;
  situation_.mode = running_ ? ExecutorMode::kExecuting : latest_.mode;
  situation_.lost = latest_.lost == nullptr ? "" : latest_.lost;
}

std::optional<ExecutionRefusal> Executor::refusal_now(const TrajectoryOrder& order) const {
  if (Clock::now() - other_heard_ < kBeside) {
    return ExecutionRefusal{ResultCode::kInvalidGoal, "another executor reports for this robot: one has to be stopped"};
  }
  return refusal_of(order, situation_);
}

// Reports once more a trajectory that ran before this start, for subscribers that were not there then.
void Executor::report_again(const History::Entry& entry) {
  ExecutionResult result;
  result.robot_id = config_.robot_id;
  result.trajectory_id = entry.id;
  result.code = entry.code.value_or(ResultCode::kGoalToleranceViolated);
  result.sentence = entry.code ? entry.sentence : "the executor ended while it ran; it is not run again";
  spdlog::info("ran before the start: id={} code={}", text(entry.id), static_cast<int>(result.code));
  port_.send(result);
}

void Executor::refuse(const RequestId& id, const ExecutionRefusal& refusal) {
  spdlog::warn("refused id={} {}", text(id), refusal.sentence);
  ExecutionResult result;
  result.robot_id = config_.robot_id;
  result.trajectory_id = id;
  result.code = refusal.code;
  result.sentence = refusal.sentence;
  port_.send(result);
}

void Executor::begin_to_prepare(TrajectoryOrder order) {
  Preparation preparation;
  preparation.began = Preparation::Clock::now();
  preparation.header.robot_id = order.robot_id;
  preparation.header.id = order.id;
  preparation.header.epoch = order.epoch;
  preparation.header.learnt = order.learnt;
  preparation.brings_stops = !order.stops.empty();
  const double lead = config_.fast ? kLongestMotion : kLead;  // without a clock nothing can run ahead
  try {
    preparation.motion = std::async(std::launch::async, [this, lead, unwanted = preparation.unwanted.get_token(),
                                                         all = std::move(order)]() mutable {
      return prepare(robot_, std::move(all), config_.tolerances, lead, unwanted);
    });
  } catch (const std::system_error& error) {  // no thread
    return refuse(preparation.header.id,
                  {ResultCode::kInvalidGoal, fmt::format("cannot be prepared: {}", error.what())});
  }
  preparing_ = std::move(preparation);
}

void Executor::conclude_preparation() {
  if (!preparing_ || preparing_->motion.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  const TrajectoryOrder header = preparing_->header;
  const ResultCode for_its_rows = header.learnt ? ResultCode::kRepetitionRefused : ResultCode::kInvalidGoal;
  try {
    auto motion = preparing_->motion.get();
    if (preparing_->unwanted.stop_requested()) throw std::runtime_error("held or stopped before it could begin");
    if (auto refusal = refusal_after_preparation(motion->order)) {
      refuse(header.id, *refusal);
    } else {
      run(std::move(motion));
    }
  } catch (const RowsRefused& error) {
    refuse(header.id, {for_its_rows, error.what()});
  } catch (const NoStop& error) {
    refuse(header.id, {for_its_rows, error.what()});
  } catch (const std::exception& error) {
    refuse(header.id, {ResultCode::kInvalidGoal, error.what()});
  }
  preparing_.reset();
}

// Checks once more after the preparation, because meanwhile the arm may have been moved, an encoder lost, or another
// executor started. The time of the preparation does not count as age of the trajectory.
std::optional<ExecutionRefusal> Executor::refusal_after_preparation(const TrajectoryOrder& order) {
  look_at_arm();
  situation_.now = order.published;
  auto refusal = refusal_now(order);
  if (refusal) refusal->sentence.insert(0, "when it could have begun: ");
  return refusal;
}

// Starts the motion. It is recorded in the history first, so that it does not run twice, whatever happens.
void Executor::run(std::unique_ptr<CommandedMotion> motion) {
  const TrajectoryOrder& order = motion->order;
  history_.begin(order.id, order.epoch);
  situation_.epoch = order.epoch;
  running_ = std::move(motion);
  spdlog::info(
      "executing id={} rows={} duration={:.3f} stops={} stops_came={:d} prepared={:.3f} since_published={:.3f}",
      text(order.id), order.rows.size(), running_->end, running_->stops->size(), preparing_->brings_stops,
      std::chrono::duration<double>(Preparation::Clock::now() - preparing_->began).count(),
      static_cast<double>(clock_.now() - order.published) * 1e-9);
  control_.begin(running_.get());
}

// Publishes the state of every tick. Of a burst, as after a long pause or on a simulated clock, only the first few and
// the latest are published.
void Executor::publish_states() {
  constexpr int kBurst = 4;
  int count = 0;
  for (auto tick = control_.state(); tick; ++count) {
    latest_ = *tick;
    ticking_ = true;
    tick = control_.state();
    if (count < kBurst || !tick) publish(latest_);
  }
}

std::optional<RequestId> Executor::about_to_begin(const TickState& tick) const {
  if (preparing_ && !preparing_->unwanted.stop_requested()) return preparing_->header.id;
  if (running_ && running_->order.id != tick.trajectory_id) return running_->order.id;  // the tick has not taken it yet
  return std::nullopt;
}

void Executor::publish(const TickState& tick) {
  ExecutorState state;
  state.robot_id = config_.robot_id;
  state.robot_hash = situation_.robot_hash;
  state.mode = tick.mode;
  state.trajectory_id = tick.trajectory_id;
  state.epoch = situation_.epoch;
  state.stamp = clock_.now();
  state.time = tick.time;
  if (const auto id = about_to_begin(tick)) {
    state.mode = ExecutorMode::kPreparing;
    state.trajectory_id = *id;
    state.time = 0;
  }
  state.q = tick.q;
  state.theta = tick.theta;
  state.dq = tick.dq;
  state.dtheta = tick.dtheta;
  state.planned_q = tick.planned_q;
  state.torque = tick.torque;
  state.feedback = tick.feedback;
  port_.send(state);
}

void Executor::conclude_finished() {
  while (control_.finished()) {
    publish_states();
    conclude(*running_);
    running_.reset();
  }
}

void Executor::conclude(CommandedMotion& motion) {
  motion.stops->give_up();
  ExecutionResult result = result_of(motion, robot_);
  result.log_file = log(motion, result);
  spdlog::info("finished id={} code={} error=({:.2e}, {:.2e}) predicted=({:.2e}, {:.2e}) residual=({:.2e}, {:.2e}) {}",
               text(result.trajectory_id), static_cast<int>(result.code), result.link_error[0], result.link_error[1],
               motion.order.predicted_error[0], motion.order.predicted_error[1], result.residual_vibration[0],
               result.residual_vibration[1], result.sentence);
  try {
    history_.end(result.trajectory_id, result.code, result.sentence);
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
  }
  publish_run(motion, result);
  port_.send(result);
  drift_watch_.add(motion);
}

// Publishes the run before its result. So the service already has the run when a client that got the result asks for
// the next repetition.
void Executor::publish_run(const CommandedMotion& motion, const ExecutionResult& result) {
  if (motion.outcome.ending == Ending::kNotBegun) return;
  unsent_runs_.push_back(run_of(motion, result));
  publish_unsent_runs();
}

// Sends the runs in their order, and tries again later if a reader is too slow.
void Executor::publish_unsent_runs() {
  if (Clock::now() < send_runs_again_) return;
  while (!unsent_runs_.empty() && port_.send(unsent_runs_.front())) unsent_runs_.pop_front();
  if (unsent_runs_.empty()) return;
  spdlog::warn("the run waits to be published id={}: a service is too slow", text(unsent_runs_.front().trajectory_id));
  if (unsent_runs_.size() > kUnsentRuns) unsent_runs_.pop_front();
  send_runs_again_ = Clock::now() + kSendAgain;
}

void Executor::report_drift() {
  std::optional<ArmDrift> drift = drift_watch_.look();
  if (!drift) return;
  drift->robot_id = config_.robot_id;
  drift->robot_hash = situation_.robot_hash;
  if (news(drift_, *drift))
    spdlog::log(drift->drifts ? spdlog::level::warn : spdlog::level::info, "arm {}", sentence_of(*drift));
  port_.send(*drift);
  drift_ = std::move(drift);
}

std::string Executor::log(const CommandedMotion& motion, const ExecutionResult& result) const {
  if (config_.logs.empty() || motion.log.size() < 2) return "";
  try {
    return write_log(motion, result, config_.logs).string();
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return "";
  }
}

void Executor::stop_silently() {
  control_.stop(true);
  if (preparing_) preparing_->unwanted.request_stop();
  for (const auto began = Clock::now(); !over_ && Clock::now() - began < kPatience;) {
    while (const auto tick = control_.state()) latest_ = *tick;
    (void)control_.finished();
    if (latest_.mode == ExecutorMode::kStopped) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void Executor::come_to_rest() {
  control_.stop(true);
  if (preparing_) preparing_->unwanted.request_stop();
  const auto began = Clock::now();
  do {
    serve_without_orders();
  } while ((running_ || preparing_ || latest_.mode != ExecutorMode::kStopped) && Clock::now() - began < kPatience &&
           !over_);
  if (running_ && !over_)
    spdlog::error("id={} has not come to rest within {} s", text(running_->order.id), kPatience.count() / 1000);
  port_.flush(kFarewell);
}

void Executor::report_lateness() const {
  spdlog::info("stopped after {} ticks, {} missed; late by {:.0f} us at p99, {:.0f} us at most", lateness_.ticks(),
               lateness_.missed(), lateness_.quantile(0.99) * 1e6, lateness_.largest() * 1e6);
}

}  // namespace fjr
