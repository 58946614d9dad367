// For what takes long and asks now and then whether it is still wanted.
#pragma once

namespace fjr {

inline bool not_stopped() { return false; }

}  // namespace fjr
