// CPU time of the calling thread, for SolveCost. The CPU time of the process would include waiting threads of a BLAS
// library.
#pragma once

#include <ctime>

namespace fjr {

// Returns the CPU time [s] of this thread.
inline double cpu_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}
inline double cpu_since(double start) { return cpu_time() - start; }

// Adds the CPU time [s] between its construction and destruction to a sum.
class CpuTimed {
 public:
  explicit CpuTimed(double& sum) : sum_(sum) {}
  ~CpuTimed() { sum_ += cpu_since(start_); }
  CpuTimed(const CpuTimed&) = delete;
  CpuTimed& operator=(const CpuTimed&) = delete;

 private:
  double& sum_;
  const double start_ = cpu_time();
};

}  // namespace fjr
