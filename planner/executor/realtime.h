// A tick that keeps its time: the scheduling of its thread, waiting for absolute instants, and how late it was.
#pragma once

#include <time.h>

#include <array>
#include <cstdint>
#include <string>

namespace fjr {

// How late ticks began, in steps of 10 us. No allocation.
class Lateness {
 public:
  void add(double seconds);

  long ticks() const { return ticks_; }
  long missed() const { return missed_; }      // whole ticks that were skipped
  double largest() const { return largest_; }  // [s]
  double quantile(double fraction) const;      // [s] rounded up; 20 ms for all beyond
  void missed(long ticks) { missed_ += ticks; }

 private:
  static constexpr double kStep = 1e-5;
  std::array<std::uint32_t, 2000> counts_{};
  long ticks_ = 0, missed_ = 0;
  double largest_ = 0;
};

// Memory of the process that stays in place, and for the calling thread the first-in first-out class at `priority` (1
// to 99; 0: neither). Returns what was not permitted, for the log; empty: all was.
std::string become_realtime(int priority);

// Wakes up at multiples of the period on the monotonic clock.
class Metronome {
 public:
  explicit Metronome(double period);

  // Until the next multiple; what has passed already is skipped and counted. Returns how many have passed since the
  // call before: 1, or more when some were missed.
  int wait(Lateness& lateness);
  // The next wait is one period from now.
  void restart();

 private:
  std::int64_t period_;  // [ns]
  std::int64_t next_;
};

}  // namespace fjr
