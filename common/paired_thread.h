// A second thread for pieces of work of some microseconds, one after another.
#pragma once

#include <sched.h>

#include <atomic>
#include <exception>
#include <functional>
#include <thread>

namespace fjr {

// The cores that the calling thread may use.
cpu_set_t allowed_cores();

class PairedThread {
 public:
  PairedThread();  // throws std::system_error where the system allows no more threads
  ~PairedThread() { end(); }
  PairedThread(const PairedThread&) = delete;
  PairedThread& operator=(const PairedThread&) = delete;

  // Does `one` on the caller's thread and `other` on this one, or where it is late on the caller's too, and returns
  // when both are done. Throws what `one` throws, or else what `other` throws. Not to be called by either, nor by two
  // threads.
  void both(const std::function<void()>& one, const std::function<void()>& other);

  // Ends it. Returns the CPU time that it took [s].
  double end();

 private:
  enum State : int { kIdle, kAsked, kBegun, kDone, kEnd };

  void tell(State state);
  bool take_back();
  void wait_until_done();
  void begin();
  void run();

  const cpu_set_t cores_ = allowed_cores();
  std::atomic<int> state_ = kIdle;
  const std::function<void()>* other_ = nullptr;
  std::exception_ptr thrown_;
  double seconds_ = 0;
  std::thread thread_;
};

}  // namespace fjr
