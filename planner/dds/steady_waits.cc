#include "planner/dds/steady_waits.h"

#include <dds/ddsrt/sync.h>
#include <dds/version.h>
#include <dlfcn.h>
#include <pthread.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <stdexcept>

static_assert(DDS_VERSION_MAJOR == 0 && DDS_VERSION_MINOR == 10, "see whether this version waits by the steady clock");

namespace {

timespec steady_instant(dds_duration_t from_now) {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  const dds_time_t until = ddsrt_time_add_duration(now.tv_sec * DDS_NSECS_IN_SEC + now.tv_nsec, from_now);
  return {until / DDS_NSECS_IN_SEC, until % DDS_NSECS_IN_SEC};
}

}  // namespace

extern "C" {

// Returns false if the time is over.
bool ddsrt_cond_waitfor(ddsrt_cond_t* condition, ddsrt_mutex_t* mutex, dds_duration_t duration) {
  if (duration == DDS_INFINITY) {
    ddsrt_cond_wait(condition, mutex);
    return true;
  }
  const timespec until = steady_instant(std::max<dds_duration_t>(duration, 0));
  const int error = ::pthread_cond_clockwait(&condition->cond, &mutex->mutex, CLOCK_MONOTONIC, &until);
  if (error != 0 && error != ETIMEDOUT) std::abort();  // as the library does
  return error == 0;
}

// Waits until an instant of the wall clock, converted to the time that is left now.
bool ddsrt_cond_waituntil(ddsrt_cond_t* condition, ddsrt_mutex_t* mutex, dds_time_t instant) {
  return ddsrt_cond_waitfor(condition, mutex, instant == DDS_NEVER ? DDS_INFINITY : instant - dds_time());
}

}  // extern "C"

namespace fjr::dds {

// The functions are looked up only once. A plugin of DDS Security is loaded with global symbols, and with it the
// library it is linked to; from then on a Python module would find the library's own functions first. By then the calls
// within the library are bound already, because Debian links it so that this happens when it is loaded.
void require_steady_waits() {
  const auto in_place = [](const char* name, auto* function) {
    return ::dlsym(RTLD_DEFAULT, name) == reinterpret_cast<void*>(function);
  };
  static const bool steady =
      in_place("ddsrt_cond_waitfor", &ddsrt_cond_waitfor) && in_place("ddsrt_cond_waituntil", &ddsrt_cond_waituntil);
  if (steady) return;
  throw std::logic_error("Cyclone DDS waits by the wall clock: the program does not export ddsrt_cond_waitfor()");
}

}  // namespace fjr::dds
