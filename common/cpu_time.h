// CPU time of this thread, for SolveCost: that of the process would count the threads that a BLAS keeps waiting.
#pragma once

#include <ctime>

namespace fjr {

// [s]
inline double cpu_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}
inline double cpu_since(double start) { return cpu_time() - start; }

// Adds the CPU time of its life to a sum.
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
