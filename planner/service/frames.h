// Messages between the service and its solving processes over pipes: a kind, a length, and bytes. Both ends are the
// same program on the same machine, so numbers are sent as they lie in memory.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace fjr {

enum class FrameKind : std::uint32_t {
  kName = 1,        // to the worker: of the request
  kSolve,           // to the worker: the request document; it starts
  kProgress,        // from the worker: stage, in front of it iteration, objective and violation
  kPlanJson,        // from the worker
  kRows,            // from the worker: samples, of a certified trajectory only
  kErrors,          // from the worker: LinkErrors of these samples
  kDone,            // from the worker: the PlanStatus and the reason
  kFindStops,       // to the worker: samples of a certified trajectory; it starts
  kFindRepetition,  // to the worker: a RunOfMotion (repetition_frame.h); it starts
  kStops,           // from the worker: their StopMotions; empty if there is none for some instant
  kIdle,            // from the worker: after every kDone, when it reads its next frame
};

struct Frame {
  FrameKind kind;
  std::string payload;
};

// Numbers as they lie in memory.
template <class T>
std::string_view as_payload(const std::vector<T>& items) {
  static_assert(std::is_trivially_copyable_v<T>);
  return {reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T)};
}
template <class T>
std::vector<T> from_payload(std::string_view payload) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<T> items(payload.size() / sizeof(T));
  if (!items.empty()) std::memcpy(static_cast<void*>(items.data()), payload.data(), items.size() * sizeof(T));
  return items;
}

// Reads a frame; blocks. Returns nothing at the end of the stream or if the data is not a frame.
std::optional<Frame> read_frame(int descriptor);

// Writes a frame; blocks. Returns false if the other end is closed.
bool write_frame(int descriptor, FrameKind kind, std::string_view payload);

}  // namespace fjr
