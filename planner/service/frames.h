// What the service and its solving processes say to each other over pipes: a kind, a length, bytes. Both ends are the
// same program on the same machine.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace fjr {

enum class FrameKind : std::uint32_t {
  kName = 1,  // to the worker: of the request
  kSolve,     // to the worker: the request document; it starts
  kProgress,  // from the worker: stage, in front of it iteration, objective and violation
  kPlanJson,  // from the worker
  kRows,      // from the worker: samples, of a certified trajectory only
  kErrors,    // from the worker: LinkErrors of these samples
  kDone,      // from the worker: the PlanStatus and the reason; it is idle again
};

struct Frame {
  FrameKind kind;
  std::string payload;
};

// Blocks; nothing at the end of the stream, and when what comes is not a frame.
std::optional<Frame> read_frame(int descriptor);

// Blocks; false: the other end is gone.
bool write_frame(int descriptor, FrameKind kind, std::string_view payload);

}  // namespace fjr
