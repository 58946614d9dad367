#include "common/paired_thread.h"

#include <pthread.h>

#include "common/cpu_time.h"

namespace fjr {
namespace {

// In pause instructions of the processor, each of which takes some ten nanoseconds:
constexpr int kAwake = 40000;    // how long the thread stays awake after its last piece of work
constexpr int kNotThere = 2000;  // how long the caller waits before it lets other threads have its core

void rest_a_moment() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("isb");
#endif
}

}  // namespace

cpu_set_t allowed_cores() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  sched_getaffinity(0, sizeof cores, &cores);
  return cores;
}

// Linux starts a thread on the core of its creator and may let it wait there for milliseconds. Therefore the new thread
// is kept off that core at first, and may use all cores again after its first piece of work (run()).
PairedThread::PairedThread() : thread_([this] { run(); }) {
  cpu_set_t others = cores_;
  CPU_CLR(static_cast<std::size_t>(sched_getcpu()), &others);
  if (CPU_COUNT(&others) > 0) pthread_setaffinity_np(thread_.native_handle(), sizeof others, &others);
}

void PairedThread::both(const std::function<void()>& one, const std::function<void()>& other) {
  other_ = &other;
  thrown_ = nullptr;
  tell(kAsked);
  try {
    one();
  } catch (...) {
    if (!take_back()) wait_until_done();
    throw;
  }
  if (take_back()) return other();
  wait_until_done();
  if (thrown_) std::rethrow_exception(thrown_);
}

double PairedThread::end() {
  if (thread_.joinable()) {
    tell(kEnd);
    thread_.join();
  }
  return seconds_;
}

void PairedThread::tell(State state) {
  state_ = state;
  state_.notify_one();
}

bool PairedThread::take_back() {
  int asked = kAsked;
  return state_.compare_exchange_strong(asked, kIdle);
}

void PairedThread::wait_until_done() {
  for (int i = 0; state_ != kDone; ++i) {
    if (i < kNotThere) {
      rest_a_moment();
    } else {
      std::this_thread::yield();
    }
  }
  state_ = kIdle;
}

void PairedThread::begin() {
  int asked = kAsked;
  if (!state_.compare_exchange_strong(asked, kBegun)) return;  // taken back
  try {
    (*other_)();
  } catch (...) {
    thrown_ = std::current_exception();
  }
  state_ = kDone;
}

void PairedThread::run() {
  const double began = cpu_time();
  bool sent_away = true;
  int moments = 0;
  for (int state = state_; state != kEnd; state = state_) {
    if (state == kAsked) {
      begin();
      moments = 0;
      if (sent_away) pthread_setaffinity_np(pthread_self(), sizeof cores_, &cores_);
      sent_away = false;
    } else if (++moments < kAwake) {
      rest_a_moment();
    } else {
      state_.wait(state);
    }
  }
  seconds_ = cpu_since(began);
}

}  // namespace fjr
