// How often `operator new` was called by this program so far.
#pragma once

namespace fjr {

long allocations();

}  // namespace fjr
