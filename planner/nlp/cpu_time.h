// CPU time of this process, for SolveCost.
#pragma once

#include <ctime>

namespace fjr {

// [s]
inline double cpu_since(std::clock_t start) { return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC; }

// Adds the CPU time of its life to a sum.
class CpuTimed {
 public:
  explicit CpuTimed(double& sum) : sum_(sum) {}
  ~CpuTimed() { sum_ += cpu_since(start_); }
  CpuTimed(const CpuTimed&) = delete;
  CpuTimed& operator=(const CpuTimed&) = delete;

 private:
  double& sum_;
  const std::clock_t start_ = std::clock();
};

}  // namespace fjr
