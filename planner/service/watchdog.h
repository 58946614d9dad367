// What systemd is told (Type=notify, WatchdogSec). Nothing happens without systemd, that is without NOTIFY_SOCKET.
#pragma once

#include <systemd/sd-daemon.h>

namespace fjr {

inline void tell_ready() { sd_notify(0, "READY=1"); }
inline void tell_alive() { sd_notify(0, "WATCHDOG=1"); }  // by the thread that does the work
inline void tell_stopping() { sd_notify(0, "STOPPING=1"); }

}  // namespace fjr
