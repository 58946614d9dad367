// Cyclone DDS 0.10 waits until instants of the wall clock. If that clock is set back by an hour, a wait takes an hour
// longer, and the library's own timers (heartbeats, leases, discovery) stop. A program linked with this file waits by
// the steady clock instead: its two functions replace those of the library, also for calls from within the library.
#pragma once

namespace fjr::dds {

// Throws std::logic_error if the library's own functions were not replaced.
void require_steady_waits();

}  // namespace fjr::dds
