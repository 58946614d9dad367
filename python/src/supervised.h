// Long work, begun from Python.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <future>
#include <mutex>
#include <optional>
#include <utility>

namespace fjr::python {

// Between the thread that works and the one that waits for it.
template <class Told>
class Wire {
 public:
  bool cancelled() const { return cancelled_; }
  void cancel() { cancelled_ = true; }

  // Only what was told last is of interest.
  void tell(Told told) {
    const std::lock_guard lock(mutex_);
    latest_ = std::move(told);
  }
  std::optional<Told> latest() {
    const std::lock_guard lock(mutex_);
    return std::exchange(latest_, std::nullopt);
  }

 private:
  std::atomic<bool> cancelled_ = false;
  std::mutex mutex_;
  std::optional<Told> latest_;
};

inline constexpr std::chrono::milliseconds kLook{50};  // Ctrl-C is seen, and progress told, so often

// Does work(wire) in a thread of its own, which knows nothing of Python. The calling thread waits without the GIL, and
// takes it for signals and to call `listener`, if that is not None, with what was told. Where a signal handler or the
// listener raises, or the listener returns False, the work is cancelled; what was raised goes on when it has ended.
template <class Told, class Work>
auto supervised(const nanobind::object& listener, Work&& work) {
  namespace nb = nanobind;
  Wire<Told> wire;
  auto result = std::async(std::launch::async, [&] { return work(wire); });
  try {
    for (bool done = false; !done;) {
      std::optional<Told> told;
      {
        const nb::gil_scoped_release others_may_run;
        done = result.wait_for(kLook) == std::future_status::ready;
        told = wire.latest();
      }
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      if (told && !listener.is_none() && listener(*told).is(nb::handle(Py_False))) wire.cancel();
    }
  } catch (...) {
    wire.cancel();
    const nb::gil_scoped_release others_may_run;
    result.wait();
    throw;
  }
  return result.get();
}

}  // namespace fjr::python
