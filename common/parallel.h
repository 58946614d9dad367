// Independent pieces of work on several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace fjr {

// Calls task(i) for every i below `count`, in no particular order, at most `threads` of them at once; with one thread
// on the caller's own. Returns the CPU time that other threads took [s]. Throws what the first of them by its index
// has thrown: on other threads when all have ended, on the caller's own at once.
double for_each_index(std::size_t count, int threads, const std::function<void(std::size_t)>& task);

// Does the same in a way of its own, which whoever calls something that has independent pieces of work chooses for it.
using ForEach = std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;

inline void one_after_another(std::size_t count, const std::function<void(std::size_t)>& task) {
  for_each_index(count, 1, task);
}

}  // namespace fjr
