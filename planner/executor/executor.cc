#include "planner/executor/executor.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <thread>
#include <utility>

namespace fjr {
namespace {

std::int64_t nanoseconds_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

Executor::Executor(const ExecutorConfig& config, const Parameters& robot, Arm& arm)
    : config_(config),
      robot_(robot),
      arm_(arm),
      port_(config.domain),
      execution_(std::make_unique<Execution>(robot_, Execution::rest(robot_, arm.link_positions()))) {
  situation_.robot_hash = robot_hash(robot_);
  situation_.started = nanoseconds_now();
}

void Executor::run() {
  spdlog::info("executing for robot={} domain={} at q=({:.4f}, {:.4f})", config_.robot_id, config_.domain,
               arm_.link_positions()[0], arm_.link_positions()[1]);
  auto next = std::chrono::steady_clock::now();
  while (!stopping_) {
    take_orders();
    tick();
    next += std::chrono::microseconds(static_cast<long>(kTick * 1e6));
    if (config_.fast && !concluded_) next = std::chrono::steady_clock::now();
    std::this_thread::sleep_until(next);
  }
  spdlog::info("stopped");
}

void Executor::take_orders() {
  for (TrajectoryOrder& order : port_.take_trajectories()) {
    if (order.robot_id == config_.robot_id) consider(std::move(order));
  }
}

void Executor::consider(TrajectoryOrder order) {
  situation_.now = nanoseconds_now();
  situation_.q = arm_.link_positions();
  if (const auto refusal = refusal_of(order, situation_)) {
    spdlog::warn("refused id={} {}", text(order.id), refusal->sentence);
    ExecutionResult result;
    result.robot_id = config_.robot_id;
    result.trajectory_id = order.id;
    result.code = refusal->code;
    result.sentence = refusal->sentence;
    return port_.send(result);
  }
  spdlog::info("executing id={} rows={} duration={:.3f}", text(order.id), order.rows.size(), order.rows.back().time);
  situation_.epoch = order.epoch;
  situation_.run.insert(order.id);
  situation_.mode = ExecutorMode::kExecuting;
  trajectory_id_ = order.id;
  execution_ = std::make_unique<Execution>(robot_, std::move(order));
  concluded_ = false;
}

void Executor::tick() {
  execution_->tick(arm_);
  if (!concluded_ && execution_->result()) conclude(*execution_->result());
  ExecutorState state = execution_->state();
  state.robot_id = config_.robot_id;
  state.robot_hash = situation_.robot_hash;
  state.mode = situation_.mode;
  state.trajectory_id = trajectory_id_;
  state.epoch = situation_.epoch;
  state.stamp = nanoseconds_now();
  port_.send(state);
}

// After a success the goal is held by the same controller; off the path the arm is held where it is.
void Executor::conclude(const ExecutionResult& result) {
  concluded_ = true;
  const bool reached = result.code == ResultCode::kSuccessful;
  situation_.mode = reached ? ExecutorMode::kResting : ExecutorMode::kHolding;
  spdlog::info("finished id={} code={} error=({:.2e}, {:.2e}) residual=({:.2e}, {:.2e}) {}", text(result.trajectory_id),
               static_cast<int>(result.code), result.link_error[0], result.link_error[1], result.residual_vibration[0],
               result.residual_vibration[1], result.sentence);
  port_.send(result);
  if (reached) return;
  execution_ = std::make_unique<Execution>(robot_, Execution::rest(robot_, arm_.link_positions()));
}

}  // namespace fjr
