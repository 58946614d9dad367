// Independent pieces of work on several threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace fjr {

// Does two pieces of work that share nothing but what neither changes, on threads as it likes, and returns when both
// are done. Throws what the first piece throws, or else what the other one does.
using DoBoth = std::function<void(const std::function<void()>& one, const std::function<void()>& other)>;

inline void one_after_the_other(const std::function<void()>& one, const std::function<void()>& other) {
  one();
  other();
}

// How many threads may work at a time, which pieces of work and pieces of those share.
class Threads {
 public:
  explicit Threads(int most) : idle_(most - 1) {}

  // Calls task(i) for every i below `count`, in no particular order, on the caller's thread, which does the first, and
  // on as many others as may work. Where none may, the caller looks again before each task. While it waits for the
  // others to end, one more may work in its place. Returns the CPU time that
  // the others took [s]. Throws what the first of the tasks by its index has thrown: at once where only the caller
  // works, otherwise when all have ended.
  double for_each(std::size_t count, const std::function<void(std::size_t)>& task);

  // Calls work(both) on the caller's thread. As soon as another may work, and a core of the machine is idle, it does
  // the other one of both pieces each time until work ends, and stays awake in between: such pieces may be as short as
  // some microseconds. Until then, and where it is late, the caller does both. Returns the CPU time that it took [s].
  // Throws what work throws.
  double in_pairs(const std::function<void(const DoBoth& both)>& work);

 private:
  class Pairs;

  std::size_t take(std::size_t most);

  // How many may be started. Below zero while a caller that has waited goes on before the one in its place has ended.
  std::atomic<int> idle_;
};

// Does the same with `threads` threads of its own; the caller's counts as one.
double for_each_index(std::size_t count, int threads, const std::function<void(std::size_t)>& task);

// Does the same in a way of its own, which whoever calls something that has independent pieces of work chooses for it.
using ForEach = std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;

inline void one_after_another(std::size_t count, const std::function<void(std::size_t)>& task) {
  for_each_index(count, 1, task);
}

}  // namespace fjr
