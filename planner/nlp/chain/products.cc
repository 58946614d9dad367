#include "planner/nlp/chain/products.h"

#include <cstddef>

#include "planner/nlp/chain/vectorised.h"

namespace fjr {

namespace {

// add_product() for kBlocks * kLanes columns at once, with the sums in registers.
template <int kBlocks>
[[gnu::always_inline]] inline void add_columns(double scale, const double* s, int s_width, std::span<const int> columns,
                                               const double* z, int width, double* to) {
  const auto count = static_cast<int>(columns.size());
  for (int i = 0; i < count; ++i) {
    Lanes sum[kBlocks] = {};
    for (int k = 0; k < count; ++k) {
      const double factor = s[i * s_width + columns[static_cast<std::size_t>(k)]];
      if (factor == 0) continue;
      for (int b = 0; b < kBlocks; ++b) sum[b] += factor * *reinterpret_cast<const Lanes*>(z + k * width + b * kLanes);
    }
    for (int b = 0; b < kBlocks; ++b) *reinterpret_cast<Lanes*>(to + i * width + b * kLanes) += scale * sum[b];
  }
}

template <int kBlocks>
[[gnu::always_inline]] inline void multiply_columns(const double* u, int count, const double* z, int rows, int width,
                                                    double* to, int u_width) {
  for (int i = 0; i < count; ++i) {
    Lanes sum[kBlocks] = {};
    for (int k = 0; k < rows; ++k) {
      const double factor = u[k * u_width + i];
      for (int b = 0; b < kBlocks; ++b) sum[b] += factor * *reinterpret_cast<const Lanes*>(z + k * width + b * kLanes);
    }
    for (int b = 0; b < kBlocks; ++b) *reinterpret_cast<Lanes*>(to + i * width + b * kLanes) = sum[b];
  }
}

}  // namespace

FJR_VECTORISED void add_product(double scale, const double* s, int s_width, std::span<const int> columns,
                                const double* z, int width, double* to) {
  int w = 0;
  for (; w + 4 * kLanes <= width; w += 4 * kLanes) add_columns<4>(scale, s, s_width, columns, z + w, width, to + w);
  for (; w < width; w += kLanes) add_columns<1>(scale, s, s_width, columns, z + w, width, to + w);
}

FJR_VECTORISED void transposed_product(const double* u, int count, const double* z, int rows, int width, double* to) {
  int w = 0;
  for (; w + 4 * kLanes <= width; w += 4 * kLanes) multiply_columns<4>(u, count, z + w, rows, width, to + w, width);
  for (; w < width; w += kLanes) multiply_columns<1>(u, count, z + w, rows, width, to + w, width);
}

FJR_VECTORISED void times_vector(const double* a, int rows, int width, const double* x, double* to) {
  for (int i = 0; i < rows; ++i) {
    Lanes sum{};
    for (int w = 0; w < width; w += kLanes) {
      sum += *reinterpret_cast<const Lanes*>(a + i * width + w) * *reinterpret_cast<const Lanes*>(x + w);
    }
    to[i] = (sum[0] + sum[2]) + (sum[1] + sum[3]);
  }
}

FJR_VECTORISED void transposed_times_vector(const double* a, int rows, int width, const double* x, double* to) {
  int w = 0;
  for (; w + 4 * kLanes <= width; w += 4 * kLanes) multiply_columns<4>(x, 1, a + w, rows, width, to + w, 1);
  for (; w < width; w += kLanes) multiply_columns<1>(x, 1, a + w, rows, width, to + w, 1);
}

}  // namespace fjr
