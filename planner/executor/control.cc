#include "planner/executor/control.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "common/smooth_step.h"
#include "planner/certificate/residual.h"
#include "planner/stop/stop_motion.h"

namespace fjr {
namespace {

constexpr double kEncodersAgree = 0.1;  // [rad] allowed |theta - q - K^-1 G(q)| at rest: for hysteresis and payload
constexpr double kRunAway = 0.2;        // [rad] motor error during a stop, beyond which feedback is switched off
constexpr double kRounding = 1e-9;      // [s]

Reading first_reading(Arm& arm) {
  const char* silent = "";
  for (int i = 0; i < 1000; ++i) {
    const Reading reading = arm.read(0);
    silent = !reading.q[0]       ? "q1"
             : !reading.q[1]     ? "q2"
             : !reading.theta[0] ? "theta1"
             : !reading.theta[1] ? "theta2"
                                 : nullptr;
    if (silent == nullptr) return reading;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  throw std::runtime_error(fmt::format("the encoder {} gives no samples", silent));
}

// Returns the one of two modes of an arm that stands still, or is going to, in which it takes more to move it again.
ExecutorMode stricter(ExecutorMode a, ExecutorMode b) {
  constexpr std::array kInOrder{ExecutorMode::kStopped, ExecutorMode::kHolding};
  for (const ExecutorMode mode : kInOrder) {
    if (a == mode || b == mode) return mode;
  }
  return ExecutorMode::kResting;
}

}  // namespace

Control::Control(const Parameters& robot, Arm& arm)
    : robot_(robot),
      arm_(arm),
      sensing_(robot),
      feedback_(robot, kTick),
      held_{{Sample{}, Sample{}}, {}},
      path_(held_),
      observer_(robot),
      swing_stop_(robot) {
  const Reading reading = first_reading(arm);
  const Joints<double> q{*reading.q[0], *reading.q[1]}, theta{*reading.theta[0], *reading.theta[1]};
  const State<double> rest = rest_at(robot, q);
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (std::abs(theta[j] - rest.theta[j]) <= kEncodersAgree) continue;
    throw std::runtime_error(fmt::format(
        "the encoders of joint {} do not fit each other: theta = {:.4f} rad where q = {:.4f} rad at rest makes it "
        "{:.4f} rad; check signs, units, gear ratio and zero offsets",
        j + 1, theta[j], q[j], rest.theta[j]));
  }
  sensing_.start(q, theta);
  hold_at(q, theta);
  feedback_.start(theta, theta);
}

// Holds the arm at rest at q from `time` on. The reference of the motors starts at theta and is blended to their
// equilibrium for q.
void Control::hold_at(const Joints<double>& q, const Joints<double>& theta, double time) {
  hold({time, rest_at(robot_, q), gravity_torque(robot_, q)});
  for (std::size_t j = 0; j < kJoints; ++j) offset_[j] = theta[j] - planned_.state.theta[j];
}

void Control::hold(const Sample& rest) {
  held_.samples[0] = held_.samples[1] = rest;
  held_.samples[1].time += kTick;
  path_ = Interpolator(held_);
  time_ = end_ = began_ = rest.time;
  offset_ = shift_ = {};
  swing_ = Swing::kNone;
  planned_ = rest;
}

Joints<double> Control::reference() const {
  const double left = 1 - smooth_step((time_ - began_) / kHandOver);
  Joints<double> theta;
  for (std::size_t j = 0; j < kJoints; ++j) {
    theta[j] = planned_.state.theta[j] + offset_[j] * left + shift_[j];
  }
  return theta;
}

void Control::tick(int ticks) {
  const Reading reading = arm_.read(ticks);
  const int missed = ticks - 1;
  const bool stalled = missed > kStallTicks && moving() && !at_rest();
  time_ += stalled ? kTick : ticks * kTick;
  if (motion_ != nullptr) motion_->missed_ticks += missed;
  const unsigned asked = asked_.exchange(0);
  obey(asked);
  take_motion(asked != 0);
  follow();
  sensing_.update(reading, planned_.state.q, reference(), ticks);
  if (stalled) stop_where_it_is(missed);
  if (swing_ == Swing::kLooking) look_at_swing();
  if (swing_ == Swing::kYielding) yield();
  supervise();
  drive(ticks);
  publish();
}

void Control::obey(unsigned asked) {
  if (asked == 0) return;
  const ExecutorMode wanted = (asked & kStop) != 0 ? ExecutorMode::kStopped : ExecutorMode::kHolding;
  if (mode_ == ExecutorMode::kExecuting && !at_rest()) {
    after_ = wanted;
    Outcome outcome;
    outcome.ending = (asked & kShutDown) != 0 ? Ending::kShutDown : Ending::kCommanded;
    outcome.what = wanted == ExecutorMode::kStopped ? "stop" : "hold";
    stop_because(outcome);
  } else if (moving()) {
    after_ = stricter(after_, wanted);
  } else {
    mode_ = stricter(mode_, wanted);
  }
}

void Control::take_motion(bool refused) {
  CommandedMotion* motion = incoming_.take();
  if (motion == nullptr) return;
  const bool free = mode_ == ExecutorMode::kResting || mode_ == ExecutorMode::kHolding;
  if (refused || !free || sensing_.lost() != nullptr) {
    motion->outcome.ending = Ending::kNotBegun;
    finished_.put(motion);
    return;
  }
  const Joints<double> from = reference();
  motion_ = motion;
  trajectory_id_ = motion->order.id;
  mode_ = ExecutorMode::kExecuting;
  after_ = ExecutorMode::kResting;
  path_ = Interpolator(motion->trajectory);
  time_ = began_ = motion->trajectory.start_time();
  end_ = motion->end;
  stop_ = nullptr;
  next_stop_ = kNoLimit;
  settled_ = false;
  const Joints<double>& start = motion->trajectory.samples.front().state.theta;
  for (std::size_t j = 0; j < kJoints; ++j) offset_[j] = from[j] - start[j];
  shift_ = {};
}

void Control::follow() {
  if (stop_ != nullptr && time_ >= next_stop_ - kRounding) {
    path_ = Interpolator(*stop_);
    stop_ = nullptr;
  }
  planned_ = swing_ == Swing::kStopping ? swing_stop_.at(time_) : path_.at(time_);
}

void Control::supervise() {
  const char* lost = sensing_.lost();
  if (lost != nullptr) {
    for (std::size_t j = 0; j < kJoints; ++j) blind_[j] = blind_[j] || sensing_.motors_lost()[j];
    after_ = stricter(after_, ExecutorMode::kHolding);
    if (mode_ == ExecutorMode::kExecuting) stop_because({.ending = Ending::kEncoderLost, .what = lost});
    if (mode_ == ExecutorMode::kResting) mode_ = ExecutorMode::kHolding;
  }
  if (mode_ == ExecutorMode::kExecuting) supervise_execution();
  if (mode_ == ExecutorMode::kStopping) supervise_stop();
  if (lost != nullptr && !moving()) {
    const Joints<bool> before = sensing_.motors_lost();
    sensing_.trust_again();
    if (sensing_.lost() == nullptr || sensing_.motors_lost() != before) rest_here();
  }
}

void Control::supervise_execution() {
  const Tolerances& allowed = motion_->tolerances;
  if (stops_run_out()) {
    after_ = stricter(after_, ExecutorMode::kHolding);
    return stop_because({.ending = Ending::kNoStop});
  }
  bool within = true;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double error = std::abs(sensing_.q()[j] - planned_.state.q[j]);
    const int joint = static_cast<int>(j) + 1;
    if (!(error <= allowed.path[j])) {
      // The reference continues from where the motors are, beside the plan, so that the arm is not pulled back into an
      // obstacle that may have stopped a link.
      move_reference(sensing_.theta());
      after_ = stricter(after_, ExecutorMode::kHolding);
      return stop_because(
          {.ending = Ending::kPathTolerance, .joint = joint, .value = error, .allowed = allowed.path[j]});
    }
    const double speed = std::abs(sensing_.dq()[j]);
    if (error <= allowed.goal[j] && speed <= allowed.stopped_velocity[j]) continue;
    within = false;
    if (!at_rest()) continue;
    motion_->outcome = {Ending::kGoalTolerance, time_, joint, error, allowed.goal[j], "rad off the goal"};
    if (error <= allowed.goal[j]) {
      motion_->outcome.value = speed;
      motion_->outcome.allowed = allowed.stopped_velocity[j];
      motion_->outcome.what = "rad/s fast";
    }
  }
  if (!at_rest()) return;
  settled_ = settled_ || within;
  const double since = time_ - end_;
  if (settled_ ? since < kWatched : since < allowed.goal_time) return;
  if (settled_) motion_->outcome = {Ending::kReached, time_, 0, 0, 0, ""};
  finish(settled_ ? after_ : stricter(after_, ExecutorMode::kHolding));
}

void Control::supervise_stop() {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (blind_[j] || std::abs(sensing_.theta()[j] - reference()[j]) < kRunAway) continue;
    run_away_ = true;
    blind_ = {true, true};
    after_ = ExecutorMode::kStopped;
  }
  if (time_ >= end_ + kWatched) finish(after_);
}

std::size_t Control::index_of_next_stop() const {
  const double since = time_ - motion_->trajectory.start_time();
  return static_cast<std::size_t>(std::floor(since / kStopSpacing + kRounding)) + 1;
}

// Returns whether the second stop from now is not checked yet. Then the next one, which is checked, must be taken.
bool Control::stops_run_out() const {
  if (!motion_->stops || at_rest()) return false;
  return motion_->stops->usable() < std::min(index_of_next_stop() + 2, motion_->stops->size());
}

// Stops from the next stop instant of the plan on. If there is no usable stop motion for it, the arm continues to the
// end of the plan, which is then the fastest way to rest.
void Control::stop_because(const Outcome& outcome) {
  mode_ = ExecutorMode::kStopping;
  motion_->outcome = outcome;
  motion_->outcome.time = time_;
  if (at_rest() || !motion_->stops) return;
  const std::size_t next = index_of_next_stop();
  if (next >= motion_->stops->usable() || motion_->stops->at(next).samples.empty()) return;
  stop_ = &motion_->stops->at(next);
  next_stop_ = stop_->start_time();
  end_ = stop_->end_time();
}

// Handles many missed ticks. The drives have braked by themselves meanwhile, so the arm is neither on the plan nor on
// any stop motion. The motors are held where they are until the observer knows how the links oscillate.
void Control::stop_where_it_is(int missed) {
  if (mode_ == ExecutorMode::kExecuting) {
    motion_->outcome = {Ending::kStalled, time_, 0, static_cast<double>(missed), kStallTicks, ""};
  }
  mode_ = ExecutorMode::kStopping;
  after_ = stricter(after_, ExecutorMode::kHolding);
  stop_ = nullptr;
  sensing_.restart();
  yielded_until_ = time_ + kMostYielding;
  hold_and_look();
}

void Control::hold_and_look() {
  const Joints<double> theta = sensing_.theta();
  feedback_.start(theta, theta);
  hold_at(resting_with(robot_, theta), theta, time_);
  end_ = time_ + kLookAtSwing;
  swing_ = Swing::kLooking;
  observer_.start(sensing_.q());
}

// Observes the oscillation of the links and decides what to do about it. If an encoder is lost, the oscillation is
// unknown, and the motors stay where they are.
void Control::look_at_swing() {
  observer_.tick(sensing_.q(), sensing_.theta());
  if (!at_rest()) return;
  swing_ = Swing::kNone;
  if (sensing_.lost() != nullptr) return;
  const Joints<double> theta = sensing_.theta();
  if (swing_stop_.find(time_, {observer_.q(), observer_.dq(), theta, {}})) {
    swing_ = Swing::kStopping;
    end_ = swing_stop_.end();
    offset_ = {};
    feedback_.start(theta, theta);
    planned_ = swing_stop_.at(time_);
  } else if (time_ < yielded_until_) {
    swing_ = Swing::kYielding;
    looked_at_ = time_;
  }
}

// Lets the motors give way, so that their damping takes energy out of an oscillation that is too large to be stopped by
// one motion. The held position follows the motors.
void Control::yield() {
  if (time_ >= looked_at_ + kYield || sensing_.lost() != nullptr) return hold_and_look();
  const Joints<double> theta = sensing_.theta();
  hold_at(resting_with(robot_, theta), theta, time_);
  swing_ = Swing::kYielding;
}

void Control::finish(ExecutorMode mode) {
  mode_ = mode;
  motion_->ended_at = sensing_.q();
  const bool beside = shift_ != Joints<double>{} || motion_->outcome.ending == Ending::kGoalTolerance;
  const bool as_learnt = motion_->order.learnt && motion_->outcome.ending == Ending::kReached;
  finished_.put(motion_);  // from here on the other thread owns it and deletes it
  motion_ = nullptr;
  if (beside) return rest_here();
  if (as_learnt) return hold({0, planned_.state, planned_.torque});  // with the model's torque the links would sag
  hold_at(planned_.state.q, planned_.state.theta);
}

// Holds the arm where it is.
void Control::rest_here() {
  const Joints<double> theta = sensing_.theta();
  feedback_.start(theta, theta);
  hold_at(sensing_.q(), theta);
  blind_ = run_away_ ? Joints<bool>{true, true} : sensing_.motors_lost();
}

// Shifts the reference so that it continues from `theta` [rad], at a constant offset from the path.
void Control::move_reference(const Joints<double>& theta) {
  const Joints<double> from = reference();
  const Joints<double> by{theta[0] - from[0], theta[1] - from[1]};
  for (std::size_t j = 0; j < kJoints; ++j) shift_[j] += by[j];
  feedback_.shift_plan(by);
}

Joints<double> Control::mean_torque() {
  if (swing_ == Swing::kLooking) return spring_torque(robot_, sensing_.q(), reference());  // holds the motors still
  if (swing_ != Swing::kStopping) return path_.mean_torque(time_, time_ + kTick);
  const Joints<double> next = swing_stop_.at(time_ + kTick).torque;
  return {(planned_.torque[0] + next[0]) / 2, (planned_.torque[1] + next[1]) / 2};
}

void Control::drive(int ticks) {
  if (swing_ == Swing::kYielding) {
    command_ = yielding_torque(robot_, sensing_.q(), sensing_.dtheta());
    return arm_.command(command_.torque);
  }
  const Joints<double> feedforward = mean_torque(), theta = reference();
  Joints<double> q = planned_.state.q;
  for (std::size_t j = 0; j < kJoints; ++j) q[j] += shift_[j];
  command_ = feedback_.command({theta, q}, planned_.state.dtheta, {sensing_.theta(), sensing_.q()}, feedforward, blind_,
                               ticks);
  arm_.command(command_.torque);
}

void Control::publish() {
  if (motion_ != nullptr) {
    const State<double> measured{sensing_.q(), sensing_.dq(), sensing_.theta(), sensing_.dtheta()};
    motion_->figures.add(robot_, {measured, planned_.state.q, command_.torque, command_.feedback, !at_rest()});
    if (motion_->log.size() < motion_->log.capacity()) {
      motion_->log.push_back({time_, sensing_.q(), sensing_.theta(), command_.torque, planned_});
    }
  }
  TickState state;
  state.mode = mode_;
  state.trajectory_id = trajectory_id_;
  state.time = time_;
  state.q = sensing_.q();
  state.theta = sensing_.theta();
  state.dq = sensing_.dq();
  state.dtheta = sensing_.dtheta();
  state.planned_q = planned_.state.q;
  state.torque = command_.torque;
  state.feedback = command_.feedback;
  state.lost = sensing_.lost();
  states_.put(state);
}

}  // namespace fjr
