// Independent pieces of work on several threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace fjr {

// A function that runs two independent pieces of work, possibly on two threads, and returns when both are done. They
// may share only data that neither changes. It throws the exception of the first piece, or else that of the other.
using DoBoth = std::function<void(const std::function<void()>& one, const std::function<void()>& other)>;

inline void one_after_the_other(const std::function<void()>& one, const std::function<void()>& other) {
  one();
  other();
}

// A limit on the number of threads that work at the same time, shared by tasks and their parallel pieces.
class Threads {
 public:
  explicit Threads(int most) : idle_(most - 1) {}

  // Calls task(i) for every i below `count`, in no particular order, on the caller's thread (which runs the first) and
  // on as many others as are available. If none is, the caller checks again before each task. While the caller waits
  // for the others to end, one more thread may work in its place. Returns the CPU time [s] that the others used. Throws
  // the exception of the task with the lowest index: at once if only the caller works, otherwise when all have ended.
  double for_each(std::size_t count, const std::function<void(std::size_t)>& task);

  // Calls work(both) on the caller's thread. As soon as another thread is available and a core of the machine is idle,
  // that thread runs the second piece of each call of `both` until work() returns, and stays awake in between, so that
  // pieces may be as short as some microseconds. Until then, and if it is late, the caller runs both pieces. Returns
  // the CPU time [s] that the other thread used. Throws the exceptions of work().
  double in_pairs(const std::function<void(const DoBoth& both)>& work);

 private:
  class Pairs;

  std::size_t take(std::size_t most);

  std::atomic<int> idle_;  // number of threads that may be started
};

// Calls task(i) likewise with `threads` threads of its own, including the caller's.
double for_each_index(std::size_t count, int threads, const std::function<void(std::size_t)>& task);

// The type of functions like for_each, by which the caller of an algorithm with independent pieces of work decides how
// they are run.
using ForEach = std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;

inline void one_after_another(std::size_t count, const std::function<void(std::size_t)>& task) {
  for_each_index(count, 1, task);
}

}  // namespace fjr
