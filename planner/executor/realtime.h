// A periodic real-time tick: scheduling of its thread, waiting for absolute times, and statistics of its lateness.
#pragma once

#include <time.h>

#include <array>
#include <cstdint>
#include <string>

namespace fjr {

// A histogram of how late ticks began, in steps of 10 us. It does not allocate.
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

// Locks the memory of the process and gives the calling thread the scheduling class SCHED_FIFO at `priority` (1 to 99;
// 0 does nothing). Returns a description of what was not permitted, for the log; empty if all was.
std::string become_realtime(int priority);

// Wakes up at multiples of the period on the monotonic clock.
class Metronome {
 public:
  explicit Metronome(double period);

  // Waits until the next multiple; those that have passed already are skipped and counted. Returns the number of
  // multiples since the previous call: 1, or more if some were missed.
  int wait(Lateness& lateness);
  // Makes the next wait end one period from now.
  void restart();

 private:
  std::int64_t period_;  // [ns]
  std::int64_t next_;
};

}  // namespace fjr
