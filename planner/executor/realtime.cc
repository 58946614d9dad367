#include "planner/executor/realtime.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>

namespace fjr {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

std::int64_t now() {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * kSecond + t.tv_nsec;
}

}  // namespace

void Lateness::add(double seconds) {
  ++ticks_;
  largest_ = std::max(largest_, seconds);
  const auto step = static_cast<std::size_t>(std::max(0.0, seconds) / kStep);
  ++counts_[std::min(step, counts_.size() - 1)];
}

double Lateness::quantile(double fraction) const {
  double below = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    below += counts_[i];
    if (below >= fraction * static_cast<double>(ticks_)) return static_cast<double>(i + 1) * kStep;
  }
  return static_cast<double>(counts_.size()) * kStep;
}

std::string become_realtime(int priority) {
  if (priority <= 0) return "";
  std::string refused;
  // Lock pages only when they are first touched, since address sanitizers reserve terabytes that are never touched.
  if (::mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0) {
    refused = std::string("memory is not locked (") + std::strerror(errno) + ")";
  }
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (const int error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters); error != 0) {
    refused += std::string(refused.empty() ? "" : ", ") + "no real-time priority (" + std::strerror(error) + ")";
  }
  return refused;
}

Metronome::Metronome(double period) : period_(static_cast<std::int64_t>(period * 1e9)), next_(now()) {}

void Metronome::restart() { next_ = now(); }

int Metronome::wait(Lateness& lateness) {
  next_ += period_;
  const timespec until{next_ / kSecond, next_ % kSecond};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
  const std::int64_t late = now() - next_;
  lateness.add(static_cast<double>(late) * 1e-9);
  const std::int64_t missed = late / period_;
  lateness.missed(missed);
  next_ += missed * period_;
  return static_cast<int>(std::min<std::int64_t>(missed + 1, std::numeric_limits<int>::max()));
}

}  // namespace fjr
