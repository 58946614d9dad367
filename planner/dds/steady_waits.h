// Cyclone DDS 0.10 waits until instants of the wall clock: when that is set back by an hour, a wait takes an hour
// longer, and the library's own timers (heartbeats, leases, discovery) stand still. A program that is linked with this
// waits by the steady clock instead: its two functions take the place of the library's, which calls them like any
// other.
#pragma once

namespace fjr::dds {

// Throws std::logic_error when the library's own functions are in place after all.
void require_steady_waits();

}  // namespace fjr::dds
