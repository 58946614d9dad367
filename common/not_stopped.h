// The default `stopped` argument of long computations that can be aborted: never stops them.
#pragma once

namespace fjr {

inline bool not_stopped() { return false; }

}  // namespace fjr
