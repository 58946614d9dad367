// The control tick: what the arm is to do now, what it does, and the modes of the executor. Nothing here allocates,
// waits or asks the system for anything; other threads speak through the mailboxes.
#pragma once

#include <atomic>

#include "planner/executor/mailbox.h"
#include "planner/executor/motion.h"
#include "planner/executor/sensing.h"
#include "planner/executor/swing_stop.h"

namespace fjr {

inline constexpr double kHandOver = 0.1;  // [s] in which what a motion's start is off the place held is faded out

// Of one tick; what is published.
struct TickState {
  ExecutorMode mode = ExecutorMode::kResting;
  RequestId trajectory_id;
  double time = 0;
  Joints<double> q{}, theta{}, dq{}, dtheta{}, planned_q{}, torque{}, feedback{};
  const char* lost = nullptr;  // an encoder without samples
};

class Control {
 public:
  // At rest where the first readings say; waits for them, at most a second. Throws std::runtime_error when an encoder
  // is silent, or when link and motor encoders cannot both be right.
  Control(const Parameters& robot, Arm& arm);

  // From one thread. ticks: that have passed since the call before; more than 1 when some were missed.
  void tick(int ticks = 1);

  // From another one.
  bool begin(CommandedMotion* motion) { return incoming_.put(motion); }  // until it comes back it is the tick's
  void hold() { asked_ |= kHold; }
  void stop(bool shut_down = false) { asked_ |= shut_down ? kStop | kShutDown : kStop; }
  std::optional<CommandedMotion*> finished() { return finished_.take(); }
  std::optional<TickState> state() { return states_.take(); }

  // From the thread of tick().
  bool moving() const { return mode_ == ExecutorMode::kExecuting || mode_ == ExecutorMode::kStopping; }

 private:
  static constexpr unsigned kHold = 1, kStop = 2, kShutDown = 4;

  void obey(unsigned asked);
  void take_motion(bool refused);
  void follow();
  void supervise();
  void supervise_execution();
  void supervise_stop();
  std::size_t index_of_next_stop() const;  // from where the motion is
  bool stops_run_out() const;
  void stop_because(const Outcome& outcome);
  void stop_where_it_is(int missed);
  void hold_and_look();
  void look_at_swing();
  void yield();
  Joints<double> mean_torque();  // planned, until the next tick
  void finish(ExecutorMode mode);
  void rest_here();
  void move_reference(const Joints<double>& theta);
  void drive();
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

  Trajectory held_;                        // where it rests without a motion: two rows
  Interpolator path_;                      // what is followed: held_, the motion's trajectory, or one of its stops
  Sample planned_{};                       // at this tick
  double time_ = 0, end_ = 0, began_ = 0;  // [s] of the path; it rests from end_ on; of the hand-over
  double next_stop_ = 0;                   // [s] when the path changes to `stop_`
  const Trajectory* stop_ = nullptr;
  Joints<double> offset_{}, shift_{};  // [rad] of the motors, beside the path: fading, staying
  Joints<bool> blind_{};
  bool run_away_ = false;

  // After missed ticks the motors are held, and the links looked at; then their swing is stopped, or where it is too
  // large for that, damped by motors that give way until it is not.
  enum class Swing { kNone, kLooking, kYielding, kStopping };
  Swing swing_ = Swing::kNone;
  double looked_at_ = 0, yielded_until_ = 0;  // [s]
  SwingObserver observer_;
  SwingStop swing_stop_;  // what is followed instead of the path

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
