// The control tick: follows the planned motion, supervises the arm, and switches the modes of the executor. Nothing
// here allocates, waits or makes system calls; other threads communicate through the mailboxes.
#pragma once

#include <atomic>

#include "planner/executor/mailbox.h"
#include "planner/executor/motion.h"
#include "planner/executor/sensing.h"
#include "planner/executor/swing_stop.h"

namespace fjr {

inline constexpr double kHandOver = 0.1;  // [s] in which the offset of a motion's start from the held place fades out

// The state in one tick, as it is published.
struct TickState {
  ExecutorMode mode = ExecutorMode::kResting;
  RequestId trajectory_id;
  double time = 0;
  Joints<double> q{}, theta{}, dq{}, dtheta{}, planned_q{}, torque{}, feedback{};
  const char* lost = nullptr;  // an encoder without samples
};

class Control {
 public:
  // Begins at rest at the first readings, for which it waits at most 1 s. Throws std::runtime_error if an encoder gives
  // none, or if link and motor encoders contradict each other.
  Control(const Parameters& robot, Arm& arm);

  // Runs one control tick. Always to be called from the same thread. ticks: number of ticks since the previous call;
  // more than 1 if some were missed.
  void tick(int ticks = 1);

  // To be called from one other thread.
  bool begin(CommandedMotion* motion) { return incoming_.put(motion); }  // the tick owns it until finished() returns it
  void hold() { asked_ |= kHold; }
  void stop(bool shut_down = false) { asked_ |= shut_down ? kStop | kShutDown : kStop; }
  std::optional<CommandedMotion*> finished() { return finished_.take(); }
  std::optional<TickState> state() { return states_.take(); }

  // To be called from the thread of tick().
  bool moving() const { return mode_ == ExecutorMode::kExecuting || mode_ == ExecutorMode::kStopping; }

 private:
  static constexpr unsigned kHold = 1, kStop = 2, kShutDown = 4;

  void obey(unsigned asked);
  void take_motion(bool refused);
  void follow();
  void supervise();
  void supervise_execution();
  void supervise_stop();
  std::size_t index_of_next_stop() const;  // seen from the current time of the motion
  bool stops_run_out() const;
  void stop_because(const Outcome& outcome);
  void stop_where_it_is(int missed);
  void hold_and_look();
  void look_at_swing();
  void yield();
  Joints<double> mean_torque();  // [N m] mean planned torque until the next tick
  void finish(ExecutorMode mode);
  void rest_here();
  void move_reference(const Joints<double>& theta);
  void drive(int ticks);
  void publish();

  void hold(const Sample& rest);
  void hold_at(const Joints<double>& q, const Joints<double>& theta, double time = 0);
  Joints<double> reference() const;
  bool at_rest() const { return time_ >= end_; }

  Parameters robot_;
  Arm& arm_;
  Sensing sensing_;
  MotorFeedback feedback_;
  ExecutorMode mode_ = ExecutorMode::kResting, after_ = ExecutorMode::kResting;

  Trajectory held_;                        // two samples of the position that is held without a motion
  Interpolator path_;                      // interpolates held_, the motion's trajectory, or one of its stops
  Sample planned_{};                       // sample of the path at this tick
  double time_ = 0, end_ = 0, began_ = 0;  // [s] on the path: now, when it comes to rest, when the hand-over began
  double next_stop_ = 0;                   // [s] when the path changes to `stop_`
  const Trajectory* stop_ = nullptr;
  Joints<double> offset_{}, shift_{};  // [rad] offsets of the motors' reference from the path: fading, and constant
  Joints<bool> blind_{};
  bool run_away_ = false;

  // After missed ticks the motors are held and the oscillation of the links is observed (kLooking). Then it is stopped
  // by a motion (kStopping) or, while it is too large for that, damped by motors that give way (kYielding).
  enum class Swing { kNone, kLooking, kYielding, kStopping };
  Swing swing_ = Swing::kNone;
  double looked_at_ = 0, yielded_until_ = 0;  // [s]
  SwingObserver observer_;
  SwingStop swing_stop_;  // followed instead of the path in kStopping

  CommandedMotion* motion_ = nullptr;
  RequestId trajectory_id_;
  bool settled_ = false;
  MotorFeedback::Command command_{};

  Slot<CommandedMotion> incoming_;
  std::atomic<unsigned> asked_ = 0;
  Ring<CommandedMotion*, 4> finished_;
  Ring<TickState, 256> states_;
};

}  // namespace fjr
