// Messages between a robot's owner and workers on other machines.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "planner/protocol/messages.h"

namespace fjr {

using WorkerId = std::array<std::uint8_t, 16>;  // random, of a worker's process; all zero: unknown

inline constexpr std::size_t kMaxSlots = 64;
inline constexpr std::size_t kMaxHeld =
    2 * kMaxSlots;  // leases: per slot one that is solved, and one whose result waits to be taken

struct LeaseId {
  std::array<std::uint8_t, 16> owner{};  // random, of the owner's process
  std::uint64_t epoch = 0;               // of the owner
  std::uint64_t number = 0;              // counted by the owner's process

  auto operator<=>(const LeaseId&) const = default;
};

struct HeldLease {
  LeaseId lease;
  Progress progress;
};

struct WorkerOffer {
  WorkerId worker{};
  std::string instance, robot_id, robot_hash, version;
  std::uint32_t slots = 0;
  std::vector<HeldLease> held;  // being solved, or solved and the result not taken yet
};

enum class LeaseKind : std::uint8_t {
  kGranted = 1,
  kOver,     // the result is not needed any more
  kRefused,  // no leases for this worker
};

enum class RefusedFor : std::uint8_t {
  kNothing = 0,
  kRobot,    // another robot.yaml
  kVersion,  // of the program
};

// Message from the owner to one worker.
struct LeaseWord {
  LeaseId lease;
  LeaseKind kind = LeaseKind::kOver;
  std::string instance;  // of the owner
  RefusedFor refused = RefusedFor::kNothing;
  std::string sentence;      // reason of a refusal
  RequestId id;              // of the request
  std::string name;          // of the request
  bool executes = false;     // stop motions are to be found as well
  std::string document;      // a complete request; or:
  std::vector<Sample> rows;  // rows of a certified trajectory, for which only stop motions are to be found
};

enum class WorkOutcome : std::uint8_t {
  kDone = 1,
  kLost,      // the solving process ended unexpectedly
  kReturned,  // not begun, or will not be finished
};

struct WorkResult {
  LeaseId lease;
  WorkerId worker{};
  WorkOutcome outcome = WorkOutcome::kReturned;  // the members below are set only with kDone
  ReplyState state = ReplyState::kFailed;
  Refusal why;
  LinkErrors errors;  // of the rows
  std::string plan_json;
  std::vector<Sample> rows;       // of a certified trajectory
  std::vector<StopMotion> stops;  // for one that is to be executed
};

}  // namespace fjr
