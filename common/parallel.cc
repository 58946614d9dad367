#include "common/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <numeric>
#include <thread>
#include <vector>

#include "common/cpu_time.h"

namespace fjr {

double for_each_index(std::size_t count, int threads, const std::function<void(std::size_t)>& task) {
  if (threads <= 1 || count <= 1) {
    for (std::size_t i = 0; i < count; ++i) task(i);
    return 0;
  }
  const std::size_t workers = std::min(count, static_cast<std::size_t>(threads));
  std::vector<std::exception_ptr> thrown(count);
  std::vector<double> seconds(workers, 0.0);
  std::atomic<std::size_t> next = 0;
  {
    std::vector<std::jthread> pool;
    for (std::size_t w = 0; w < workers; ++w) {
      pool.emplace_back([&, w] {
        const double began = cpu_time();
        for (std::size_t i = next++; i < count; i = next++) {
          try {
            task(i);
          } catch (...) {
            thrown[i] = std::current_exception();
          }
        }
        seconds[w] = cpu_since(began);
      });
    }
  }
  for (const std::exception_ptr& exception : thrown) {
    if (exception) std::rethrow_exception(exception);
  }
  return std::accumulate(seconds.begin(), seconds.end(), 0.0);
}

}  // namespace fjr
