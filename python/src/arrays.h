// Rows of numbers as NumPy arrays.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "planner/trajectory/trajectory.h"

namespace fjr::python {

using Array = nanobind::ndarray<nanobind::numpy, const double>;

static_assert(sizeof(Sample) % sizeof(double) == 0);
inline constexpr std::int64_t kSampleStride = sizeof(Sample) / sizeof(double);

// A column of the samples, seen and not copied: (rows) for one value, (rows, 2) for two that stand side by side. The
// owner lives as long as the array. Read-only, for what was certified is not to be changed.
inline Array column(const std::vector<Sample>& samples, const double* first, std::size_t width,
                    nanobind::handle owner) {
  const std::array<std::size_t, 2> shape{samples.size(), width};
  const std::array<std::int64_t, 2> strides{kSampleStride, 1};
  return {first, width == 1 ? 1U : 2U, shape.data(), owner, strides.data()};
}

inline constexpr std::array<const char*, 6> kColumnNames{"time", "q", "dq", "theta", "dtheta", "tau"};

// The columns of the samples by their names.
inline Array column(const std::vector<Sample>& samples, std::size_t name, nanobind::handle owner) {
  static const Sample none{};
  const Sample& first = samples.empty() ? none : samples.front();
  const std::array<const double*, 6> starts{&first.time,
                                            first.state.q.data(),
                                            first.state.dq.data(),
                                            first.state.theta.data(),
                                            first.state.dtheta.data(),
                                            first.torque.data()};
  return column(samples, starts[name], name == 0 ? 1 : 2, owner);
}

// Samples that nobody else has, as {"time": (n), "q": (n, 2), ...}.
inline nanobind::dict columns_of(std::vector<Sample> samples) {
  auto kept = std::make_unique<std::vector<Sample>>(std::move(samples));
  const std::vector<Sample>& rows = *kept;
  const nanobind::capsule owner(kept.release(), [](void* p) noexcept { delete static_cast<std::vector<Sample>*>(p); });
  nanobind::dict columns;
  for (std::size_t i = 0; i < kColumnNames.size(); ++i) columns[kColumnNames[i]] = column(rows, i, owner);
  return columns;
}

// (n, 2) of values that nobody else has.
inline Array pairs(std::vector<Joints<double>> values) {
  auto kept = std::make_unique<std::vector<Joints<double>>>(std::move(values));
  const std::array<std::size_t, 2> shape{kept->size(), 2};
  static constexpr Joints<double> kNone{};
  const double* first = kept->empty() ? kNone.data() : kept->front().data();
  const nanobind::capsule owner(kept.release(),
                                [](void* p) noexcept { delete static_cast<std::vector<Joints<double>>*>(p); });
  return {first, 2, shape.data(), owner};
}

}  // namespace fjr::python
