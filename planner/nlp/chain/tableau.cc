#include "planner/nlp/chain/tableau.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "planner/nlp/chain/vectorised.h"

namespace fjr {
namespace {

// A pivot is accepted if its magnitude exceeds this fraction of the largest in its row, which bounds the factors of the
// other variables. A first pass over the rows takes good pivots, a second one accepts smaller ones.
constexpr std::array<double, 2> kFractions{0.1, 0.01};

// After elimination, entries below this fraction of the row's original magnitude count as zero.
constexpr double kDependent = 1e-13;

FJR_VECTORISED double largest_of(const double* row, int width) {
  Lanes largest{};
  for (int w = 0; w < width; w += kLanes) {
    Lanes size = *reinterpret_cast<const Lanes*>(row + w);
    make_magnitude(size);
    keep_larger(largest, size);
  }
  return largest_lane(largest);
}

struct Choice {
  int column;
  double fraction;
};

// Returns the column with the largest magnitude times preference (the first of equal ones), and the ratio of its
// magnitude to the largest one among the columns marked in `bounding`.
FJR_VECTORISED Choice choose(const double* row, const double* preference, const double* bounding, int width) {
  Lanes best{}, bound{}, best_at{}, block{};
  for (int w = 0; w < width; w += kLanes) {
    Lanes size = *reinterpret_cast<const Lanes*>(row + w);
    make_magnitude(size);
    const Lanes product = size * *reinterpret_cast<const Lanes*>(preference + w);
    best_at = product > best ? block : best_at;
    keep_larger(best, product);
    keep_larger(bound, size * *reinterpret_cast<const Lanes*>(bounding + w));
    block += kLanes;
  }
  const double largest = largest_lane(best), limit = largest_lane(bound);
  if (largest == 0) return {-1, 0};
  int c = width;
  for (int lane = 0; lane < kLanes; ++lane) {
    if (best[lane] == largest) c = std::min(c, static_cast<int>(best_at[lane]) + lane);
  }
  return {c, std::fabs(row[c]) / limit};
}

// Solves row r for the variable of column c and substitutes it in all other rows. Column c is written last, because a
// vector read of memory that was just partly written stalls.
template <int kBlocks>
[[gnu::always_inline]] inline void exchange_rows(double* a, int rows, int r, int c) {
  constexpr int kWidth = kBlocks * kLanes;
  double* pivot_row = a + r * kWidth;
  const double inverse = 1 / pivot_row[c];
  Lanes from[kBlocks];
  for (int w = 0; w < kBlocks; ++w) {
    Lanes& block = *reinterpret_cast<Lanes*>(pivot_row + w * kLanes);
    from[w] = block * inverse;
    block = from[w];
  }
  pivot_row[c] = inverse;
  for (int i = 0; i < rows; ++i) {
    double* to = a + i * kWidth;
    const double factor = to[c];
    if (i == r || factor == 0) continue;
    for (int w = 0; w < kBlocks; ++w) *reinterpret_cast<Lanes*>(to + w * kLanes) -= factor * from[w];
    to[c] = -factor * inverse;
  }
}

// Keeps the pivot row in registers for the usual widths, and in memory for all others.
FJR_VECTORISED void exchange(double* a, int rows, int width, int r, int c) {
  switch (width / kLanes) {
    case 6:
      return exchange_rows<6>(a, rows, r, c);
    case 7:
      return exchange_rows<7>(a, rows, r, c);
    case 8:
      return exchange_rows<8>(a, rows, r, c);
    default:
      break;
  }
  double* from = a + r * width;
  const double inverse = 1 / from[c];
  for (int w = 0; w < width; w += kLanes) *reinterpret_cast<Lanes*>(from + w) *= inverse;
  from[c] = inverse;
  for (int i = 0; i < rows; ++i) {
    double* to = a + i * width;
    const double factor = to[c];
    if (i == r || factor == 0) continue;
    for (int w = 0; w < width; w += kLanes) {
      *reinterpret_cast<Lanes*>(to + w) -= factor * *reinterpret_cast<const Lanes*>(from + w);
    }
    to[c] = -factor * inverse;
  }
}

}  // namespace

void Tableau::reset(int rows, int columns) {
  a_.resize_to_zero(rows, columns);
  basic_.assign(static_cast<std::size_t>(rows), -1);
  row_of_.assign(static_cast<std::size_t>(columns), -1);
}

bool Tableau::solve_for_basis(double* preference, double* bounding) {
  size_.clear();
  for (int r = 0; r < rows(); ++r) size_.push_back(largest_of(row(r), width()));
  for (const double least : kFractions) {
    for (int r = 0; r < rows(); ++r) {
      const auto at = static_cast<std::size_t>(r);
      if (basic_[at] >= 0) continue;
      const auto [column, fraction] = choose(row(r), preference, bounding, width());
      if (fraction < least || std::fabs(row(r)[column]) <= kDependent * size_[at]) continue;
      exchange(a_.data(), rows(), width(), r, column);
      const auto c = static_cast<std::size_t>(column);
      basic_[at] = column;
      row_of_[c] = r;
      preference[c] = bounding[c] = 0;
    }
  }
  bool independent = true;
  for (int r = 0; r < rows(); ++r) {
    if (basic(r) >= 0) continue;
    double left = 0;
    for (int j = 0; j < columns(); ++j) left = row_of(j) >= 0 ? left : std::max(left, std::fabs(row(r)[j]));
    independent = independent && left > kDependent * size_[static_cast<std::size_t>(r)];
  }
  return independent;
}

}  // namespace fjr
