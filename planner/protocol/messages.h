// Messages between clients and the service, independent of the transport.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/stop/stop.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// A DDS participant by its DDS name: one client, whatever ids it uses. All zero: unknown.
using Origin = std::array<std::uint8_t, 16>;

inline constexpr std::size_t kLongestName = 64;          // [bytes] of a robot_id, and of an instance: idl/fjr_msgs.idl
inline constexpr std::size_t kLongestPlanJson = 262144;  // [bytes] in a reply
inline constexpr double kLongestMotion = 20;             // [s] of motions that an executor runs

struct RequestId {
  std::array<std::uint8_t, 16> client{};
  std::uint64_t number = 0;

  auto operator<=>(const RequestId&) const = default;
};

std::string client_name(const RequestId& id);  // 32 hexadecimal digits: also the client's partition
std::string text(const RequestId& id);         // "0123456789ab-7", short, for logs
RequestId new_client();                        // random, number 0

std::string to_text(const RequestId& id);  // the full id: the client's 32 digits, a minus, the number
std::optional<RequestId> request_id_from(std::string_view text);

enum class ReplyState : std::uint8_t {  // ACCEPTED is followed by one of the others; REJECTED comes at once
  kAccepted = 1,
  kRejected,
  kSolved,
  kInfeasible,
  kFailed,
  kCancelled,
  kExpired,
};

enum class Reason : std::uint8_t {
  kNone = 0,
  kBadInput,
  kQueueFull,
  kWrongRobot,
  kInfeasible,
  kNotConverged,
  kUncertified,
  kBudget,
  kCancelled,
  kWorkerLost,
  kShuttingDown,
  kUnsupported,
  kArmNotAtRest,
  kNoTrajectory,
  kClientGone,
};

const char* name(ReplyState state);  // "SOLVED", ...
const char* name(Reason reason);     // "BAD_INPUT", ...

struct Refusal {
  Reason reason = Reason::kNone;
  std::string field;     // of the request; may be empty
  std::string sentence;  // for people
};

enum class Action : std::uint8_t {
  kPlan = 0,
  kPlanAndExecute,
  kExecute,  // a motion planned before
  kRepeat,   // a motion planned before, corrected by the deviation of its last run
};

// Returns whether an action is about a motion planned before; such orders have no document.
inline bool of_earlier_plan(Action action) { return action == Action::kExecute || action == Action::kRepeat; }

// One request as it is sent. Its motion is text as in a request file; once read, it is a Request.
struct Order {
  RequestId id;
  std::string name;
  Action action = Action::kPlan;
  RequestId trajectory_id;  // with of_earlier_plan(): id of the planned motion, or of any run of it
  int priority = 0;         // larger goes first
  double budget = 0;        // [s]; 0: the service's default
  double start_within = 0;  // [s] after its client's last sign of life until which the arm may start; 0: the default
  std::string robot_id;     // empty: any served robot
  std::string robot_hash;   // empty: any
  std::string document;     // text of the motion; empty if it came as numbers
  std::optional<Request> motion;   // set if it came as numbers, or once the document was read
  Origin origin{};                 // set by the receiving side
  bool needs_executor = false;     // set by the receiving side: cannot be checked before the executor is known
  std::optional<Refusal> refusal;  // set by the receiving side if the request is malformed
};

// Link errors of a certified trajectory [rad]: allowed by the certificate, and predicted for the executor.
struct LinkErrors {
  Joints<double> certified{}, predicted{};
};

struct Reply {
  RequestId id;
  ReplyState state = ReplyState::kRejected;
  Refusal why;  // empty when accepted or solved
  std::string robot_id, robot_hash, request_hash, version;
  double solve_time = 0, wait_time = 0;  // [s]
  std::string plan_json;                 // empty when nothing was planned
  LinkErrors errors;                     // of the rows
  std::vector<Sample> rows;              // of a certified trajectory, otherwise empty
  std::vector<StopMotion> stops;         // for a trajectory that is executed; known only to the service that planned it
  bool rest_to_rest = false;             // known to services only, like the errors
  Origin origin{};                       // of the request; known to the service that answers only
  RequestId motion;                      // the planned motion of which this is a run; known to services only
  bool learnt = false;                   // rows were corrected by runs of the motion; known to services only

  bool final() const { return state != ReplyState::kAccepted; }
};

std::size_t size_of(const Order& order);  // [bytes] of memory
std::size_t size_of(const Reply& reply);

using SharedReply = std::shared_ptr<const Reply>;  // sent, and kept for repetitions

struct ProgressReport {
  RequestId id;
  std::uint32_t queue_position = 0;  // 0: being solved
  Progress progress;
  double elapsed = 0;  // [s] since arrival
};

struct ServiceStatus {
  std::string instance, robot_id, robot_hash, version;
  std::uint64_t epoch = 0;  // of its trajectories; 0: another instance owns the robot
  double uptime = 0;        // [s]
  std::uint32_t queued = 0, queue_capacity = 0, workers = 0, solving = 0, workers_lost = 0;
  std::uint64_t received = 0, duplicates = 0;
  std::uint64_t solved = 0, rejected = 0, infeasible = 0, failed = 0, cancelled = 0, expired = 0;
  double latency_p50 = 0, latency_p90 = 0, latency_p99 = 0;  // [s] arrival to reply, of the last solved ones
  std::uint64_t memory = 0;                                  // [bytes] resident, workers included
};

// Converts a plan's status to the state and reason of a reply, and back.
ReplyState state_of(PlanStatus status);
Reason reason_of(PlanStatus status);
PlanStatus status_of(const Reply& reply);

}  // namespace fjr
