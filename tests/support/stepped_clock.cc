// Preloaded: a wall clock that a test can step. It is the system's plus what the file FJR_CLOCK_STEP says, eight bytes
// of nanoseconds. Condition variables that wait for an instant of the wall clock wait for this one's.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kGlance = 10'000'000;  // [ns] how often a wait looks at the clock, which may have been stepped

const std::atomic<std::int64_t>* step_file() {
  static const std::atomic<std::int64_t> none = 0;
  const char* name = std::getenv("FJR_CLOCK_STEP");
  const int file = name == nullptr ? -1 : ::open(name, O_RDONLY | O_CLOEXEC);
  if (file < 0) return &none;
  void* const mapped = ::mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, file, 0);
  ::close(file);
  return mapped == MAP_FAILED ? &none : static_cast<const std::atomic<std::int64_t>*>(mapped);
}

std::int64_t nanoseconds(const timespec& t) { return t.tv_sec * kSecond + t.tv_nsec; }
timespec time_of(std::int64_t nanoseconds) { return {nanoseconds / kSecond, nanoseconds % kSecond}; }

std::int64_t now_of(clockid_t clock) {
  static const std::atomic<std::int64_t>* const step = step_file();
  timespec now{};
  ::syscall(SYS_clock_gettime, clock, &now);
  return nanoseconds(now) + (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE ? step->load() : 0);
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* result) noexcept {
  if (clock != CLOCK_REALTIME && clock != CLOCK_REALTIME_COARSE) {
    return static_cast<int>(::syscall(SYS_clock_gettime, clock, result));
  }
  *result = time_of(now_of(clock));
  return 0;
}

int gettimeofday(timeval* result, void*) noexcept {
  const std::int64_t now = now_of(CLOCK_REALTIME);
  *result = {now / kSecond, now % kSecond / 1000};
  return 0;
}

time_t time(time_t* result) noexcept {
  const time_t now = now_of(CLOCK_REALTIME) / kSecond;
  if (result != nullptr) *result = now;
  return now;
}

int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex, const timespec* until) {
  for (;;) {
    const std::int64_t left = nanoseconds(*until) - now_of(CLOCK_REALTIME);
    if (left <= 0) return ETIMEDOUT;
    const timespec glance = time_of(now_of(CLOCK_MONOTONIC) + std::min(left, kGlance));
    const int returned = ::pthread_cond_clockwait(condition, mutex, CLOCK_MONOTONIC, &glance);
    if (returned != ETIMEDOUT) return returned;
  }
}

}  // extern "C"
