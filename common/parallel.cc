#include "common/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <numeric>
#include <thread>
#include <vector>

#include "common/cpu_time.h"

namespace fjr {

std::size_t Threads::take(std::size_t most) {
  std::size_t taken = 0;
  for (int idle = idle_; taken < most && idle > 0;) {
    if (idle_.compare_exchange_weak(idle, idle - 1)) ++taken;
  }
  return taken;
}

double Threads::for_each(std::size_t count, const std::function<void(std::size_t)>& task) {
  const std::size_t others = count > 1 ? take(count - 1) : 0;
  if (others == 0) {
    for (std::size_t i = 0; i < count; ++i) task(i);
    return 0;
  }
  std::vector<std::exception_ptr> thrown(count);
  std::vector<double> seconds(others, 0.0);
  std::atomic<std::size_t> next = 1;
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
  {
    std::vector<std::jthread> pool;
    for (std::size_t w = 0; w < others; ++w) {
      pool.emplace_back([&, w] {
        const double began = cpu_time();
        work();
        seconds[w] = cpu_since(began);
        ++idle_;
      });
    }
    // A caller that only waits leaves its core idle for milliseconds: Linux begins all new threads on the other cores.
    // The first task is the caller's, for it may have pieces of its own, and find all the others idle in the end.
    try_task(0);
    work();
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
