// Messages between the service, the executor and clients about executing a trajectory, independent of the transport.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "planner/protocol/messages.h"
#include "planner/stop/stop.h"

namespace fjr {

struct Log;

// Tolerances as in ros2_control's joint_trajectory_controller; 0 means the executor's default.
struct Tolerances {
  Joints<double> path{};              // [rad] of the links, at any instant
  Joints<double> goal{};              // [rad] of the links, at the end
  double goal_time = 0;               // [s] allowed beyond the end to get within `goal`
  Joints<double> stopped_velocity{};  // [rad/s]
};

// Wider tolerances, of a trajectory or of the executor's configuration, would not protect the arm.
inline constexpr double kWidestTolerance = 0.5;  // [rad], [rad/s]
inline constexpr double kLongestGoalTime = 60;   // [s]
// Executors accept trajectories whose first row is no further than this from where the links are. [rad]
inline constexpr double kStartTolerance = 0.01;

// Signature of a trajectory's publisher (planner/protocol/signature.h).
struct Signature {
  std::string value;   // empty: not signed
  std::string signer;  // certificate, DER
};

struct TrajectoryOrder {
  std::string robot_id;
  RequestId id;  // of the request; never run twice
  std::uint64_t epoch = 0;
  std::int64_t published = 0;  // [ns] since 1970 by the executor's clock: its stamp when it was published
  std::string robot_hash, request_hash;
  bool certified = false, ends_at_rest = false;
  Joints<double> certified_error{},
      predicted_error{};  // [rad] of the links: allowed by the certificate; for the executor
  Tolerances tolerances;
  std::vector<Sample> rows;
  std::vector<StopMotion> stops;  // one per kStopSpacing; empty: the executor finds them itself
  bool learnt = false;  // rows were corrected by the deviations of earlier runs; published on a topic of its own
  Signature signature;
};

enum class ExecutorCommand : std::uint8_t { kHold = 1, kStop };

struct ExecutorOrder {
  std::string robot_id;
  RequestId id;
  ExecutorCommand command = ExecutorCommand::kHold;
};

enum class ExecutorMode : std::uint8_t { kResting = 1, kExecuting, kStopping, kHolding, kStopped, kPreparing };

struct ExecutorState {
  std::string robot_id, robot_hash;
  ExecutorMode mode = ExecutorMode::kResting;
  RequestId trajectory_id;
  std::uint64_t epoch = 0;
  std::int64_t stamp = 0;                    // [ns] since 1970 by a clock that is not stepped while the executor runs
  double time = 0;                           // [s] within the trajectory
  Joints<double> q{}, theta{}, planned_q{};  // [rad] by the encoders; planned
  Joints<double> dq{}, dtheta{};             // [rad/s] filtered differentiation
  Joints<double> torque{}, feedback{};       // [N m] commanded, and the part of it that is feedback
};

enum class ResultCode : std::int32_t {  // those of FollowJointTrajectory, and one more
  kSuccessful = 0,
  kInvalidGoal = -1,
  kInvalidJoints = -2,
  kOldHeaderTimestamp = -3,
  kPathToleranceViolated = -4,
  kGoalToleranceViolated = -5,
  kRepetitionRefused = -6,  // this executor does not run these learnt rows, wherever the arm is
};

bool has_moved(ResultCode code);      // whether the arm has moved, or else the motion was refused
const char* name(ResultCode code);    // "SUCCESSFUL", ...
const char* name(ExecutorMode mode);  // "resting", ...

struct LimitMargin {
  std::string name;
  int joint = 0;                  // 1 or 2; 0 for tip_speed
  double limit = 0, reached = 0;  // magnitudes, in the limit's unit
};

struct ExecutionResult {
  std::string robot_id;
  RequestId trajectory_id;
  ResultCode code = ResultCode::kSuccessful;
  std::string sentence;
  Joints<double> link_error{}, link_error_rms{}, final_link_error{};  // [rad]
  Joints<double> residual_vibration{};                                // [rad] largest |q - goal| after the end
  Joints<double> feedback_torque{};                                   // [N m] largest
  std::vector<LimitMargin> limits;
  std::string log_file;  // on the executor's machine; empty: none
};

struct ExecutedRow {
  double time = 0;                              // [s] of the trajectory
  Joints<double> q{}, theta{};                  // [rad] by the encoders
  Joints<double> torque{};                      // [N m] commanded from then on
  Joints<double> planned_q{}, planned_theta{};  // [rad]
};

// The log of a trajectory that has moved the arm, tick by tick.
struct ExecutedRun {
  std::string robot_id, robot_hash;
  RequestId trajectory_id;
  ResultCode code = ResultCode::kSuccessful;
  std::string sentence;
  std::uint32_t missed_ticks = 0;
  std::vector<ExecutedRow> rows;
};

// Result of monitoring, over all motions since the executor's start, whether the arm still matches the executor's
// robot.yaml.
struct ArmDrift {
  std::string robot_id, robot_hash;
  std::uint64_t motions = 0;  // number of motions that were examined
  bool drifts = false;        // `evidence` is above `alarm`
  double evidence = 0,
         alarm = 0;             // without a drift it takes at least `alarm` motions in the mean until evidence > alarm
  std::string parameter, unit;  // that explains the evidence best, as in "spring.stiffness[0]"
  double share = 0;             // fraction of the evidence that this parameter explains, from 0 to 1
  double known = 0;             // its value in robot.yaml
  double change = 0, change_error = 0;  // estimated deviation from that value, and its standard error
  RequestId since;                      // first trajectory with the drift
  std::uint64_t motions_since = 0;      // number of motions from that one on
};

// Returns the rows as a log with columns of measured, commanded and planned values, and the number of missed ticks.
Log log_of(const std::vector<ExecutedRow>& ticks, std::uint32_t missed_ticks);

// Returns whether `now` is news compared with `before`: a drift, another cause of it, or its end.
bool news(const std::optional<ArmDrift>& before, const ArmDrift& now);

// Returns a sentence for people: what drifts, by how much, since when; or that nothing does.
std::string sentence_of(const ArmDrift& drift);

}  // namespace fjr
