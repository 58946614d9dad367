// A helper thread for many consecutive pieces of work of some microseconds each.
#pragma once

#include <sched.h>

#include <atomic>
#include <exception>
#include <functional>
#include <thread>

namespace fjr {

// Returns the cores that the calling thread may use.
cpu_set_t allowed_cores();

class PairedThread {
 public:
  PairedThread();  // throws std::system_error where the system allows no more threads
  ~PairedThread() { end(); }
  PairedThread(const PairedThread&) = delete;
  PairedThread& operator=(const PairedThread&) = delete;

  // Runs `one` on the caller's thread and `other` on this one, or also on the caller's if this one is late. Returns
  // when both are done. Throws the exception of `one`, or else that of `other`. Must not be called by either of them,
  // nor by two threads.
  void both(const std::function<void()>& one, const std::function<void()>& other);

  // Ends the thread. Returns the CPU time [s] that it used.
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
