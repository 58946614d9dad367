#include "common/parallel.h"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <fstream>
#include <numeric>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "common/cpu_time.h"
#include "common/paired_thread.h"

namespace fjr {

namespace {

// Returns whether a core is idle. Two threads that wait for each other every few microseconds are slower than one if
// they have to share a core with others.
bool core_is_idle() {
  const cpu_set_t cores = allowed_cores();
  std::string loads;
  int running = 1;  // threads, this one included; where that cannot be known, it is assumed to be alone
  std::ifstream("/proc/loadavg") >> loads >> loads >> loads >> running;
  return running < CPU_COUNT(&cores);
}

}  // namespace

// A second thread from when there may be one.
class Threads::Pairs {
 public:
  explicit Pairs(Threads& threads) : threads_(threads) {}
  ~Pairs() { end(); }
  Pairs(const Pairs&) = delete;
  Pairs& operator=(const Pairs&) = delete;

  void both(const std::function<void()>& one, const std::function<void()>& other) {
    if (!thread_ && threads_.idle_ > 0) ask();
    if (!thread_) return one_after_the_other(one, other);
    thread_->both(one, other);
  }

  // Returns the CPU time that it took [s].
  double end() {
    if (!thread_) return 0;
    const double seconds = thread_->end();
    thread_.reset();
    ++threads_.idle_;
    return seconds;
  }

 private:
  using Clock = std::chrono::steady_clock;

  void ask() {
    constexpr std::chrono::milliseconds kSeldom{5};  // asking the system takes some 20 us
    const Clock::time_point now = Clock::now();
    if (asked_ && now - *asked_ < kSeldom) return;
    asked_ = now;
    if (!core_is_idle() || threads_.take(1) == 0) return;
    try {
      thread_.emplace();
    } catch (const std::system_error&) {  // the system allows no more threads
      ++threads_.idle_;
    }
  }

  Threads& threads_;
  std::optional<Clock::time_point> asked_;
  std::optional<PairedThread> thread_;
};

double Threads::in_pairs(const std::function<void(const DoBoth&)>& work) {
  Pairs pairs(*this);
  work([&](const auto& one, const auto& other) { pairs.both(one, other); });
  return pairs.end();
}

std::size_t Threads::take(std::size_t most) {
  std::size_t taken = 0;
  for (int idle = idle_; taken < most && idle > 0;) {
    if (idle_.compare_exchange_weak(idle, idle - 1)) ++taken;
  }
  return taken;
}

double Threads::for_each(std::size_t count, const std::function<void(std::size_t)>& task) {
  std::size_t first = 0, others = 0;
  for (; first < count; ++first) {  // one by one while no other thread is idle
    others = take(count - first - 1);
    if (others > 0) break;
    task(first);
  }
  if (others == 0) return 0;
  std::vector<std::exception_ptr> thrown(count);
  std::vector<double> seconds(others, 0.0);
  std::atomic<std::size_t> next = first + 1, working = others + 1;  // the caller included
  const auto try_task = [&](std::size_t i) {
    try {
      task(i);
    } catch (...) {
      thrown[i] = std::current_exception();
    }
  };
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) try_task(i);
  };
  // The last to end keeps its place, which is the caller's from then on.
  const auto leave = [&] {
    if (--working > 0) ++idle_;
  };
  {
    std::vector<std::jthread> pool;
    pool.reserve(others);
    try {
      while (pool.size() < others) {
        pool.emplace_back([&, w = pool.size()] {
          const double began = cpu_time();
          work();
          seconds[w] = cpu_since(began);
          leave();
        });
      }
    } catch (const std::system_error&) {  // the system allows no more threads: there are fewer from now on
      working -= others - pool.size();
    }
    // The caller works as well, because Linux starts all new threads on other cores and would leave the caller's core
    // idle for milliseconds. It runs the first task, which may have parallel pieces of its own for threads that are
    // idle by then.
    try_task(first);
    work();
    leave();
  }
  for (const std::exception_ptr& exception : thrown) {
    if (exception) std::rethrow_exception(exception);
  }
  return std::accumulate(seconds.begin(), seconds.end(), 0.0);
}

double for_each_index(std::size_t count, int threads, const std::function<void(std::size_t)>& task) {
  return Threads(threads).for_each(count, task);
}

}  // namespace fjr
