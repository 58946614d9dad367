#include "planner/nlp/chain/dense_ldlt.h"

#include <algorithm>
#include <cmath>

#include "planner/nlp/chain/vectorised.h"

namespace fjr {
namespace {

// A pivot of a smaller magnitude counts as zero.
constexpr double kZero = 1e-20;

// Pivots that pass the stability test with this threshold are taken first. Only if there are none, the caller's lower
// threshold is used, before pivots are delayed.
constexpr double kComfortable = 1e-2;

// Rows of active constraints on states find no good pivot before the block that determines those states. Up to 10 such
// rows were seen to be delayed at a time. Where a finely meshed problem is badly scaled, more would accumulate along
// the chain; beyond this number, pivots are judged by the scaled matrix instead. Without that, an iteration with 800
// intervals took three times as long as four with 200.
constexpr int kMostWaiting = 16;

// Eliminates row p with the pivot d: updates all rows below and divides row p by d. The columns up to p are not read
// again and may be overwritten.
FJR_VECTORISED void subtract_one(double* a, int n, int width, int p, double d) {
  double* from = a + p * width;
  const double inverse = 1 / d;
  const int first = (p + 1) / kLanes * kLanes;
  for (int i = p + 1; i < n; ++i) {
    const double l = from[i] * inverse;
    if (l == 0) continue;
    double* to = a + i * width;
    for (int w = first; w < width; w += kLanes) {
      *reinterpret_cast<Lanes*>(to + w) -= l * *reinterpret_cast<const Lanes*>(from + w);
    }
  }
  for (int i = p + 1; i < n; ++i) from[i] *= inverse;
}

// Eliminates rows p and p + 1 with the 2 x 2 pivot (d0 e0; e0 d1).
FJR_VECTORISED void subtract_two(double* a, int n, int width, int p, double d0, double e0, double d1) {
  double *from0 = a + p * width, *from1 = from0 + width;
  const double inverse = 1 / (d0 * d1 - e0 * e0), b00 = d1 * inverse, b01 = -e0 * inverse, b11 = d0 * inverse;
  const int first = (p + 2) / kLanes * kLanes;
  for (int i = p + 2; i < n; ++i) {
    const double u = b00 * from0[i] + b01 * from1[i], v = b01 * from0[i] + b11 * from1[i];
    if (u == 0 && v == 0) continue;
    double* to = a + i * width;
    for (int w = first; w < width; w += kLanes) {
      *reinterpret_cast<Lanes*>(to + w) -=
          u * *reinterpret_cast<const Lanes*>(from0 + w) + v * *reinterpret_cast<const Lanes*>(from1 + w);
    }
  }
  for (int i = p + 2; i < n; ++i) {
    const double u = b00 * from0[i] + b01 * from1[i], v = b01 * from0[i] + b11 * from1[i];
    from0[i] = u;
    from1[i] = v;
  }
  from0[p + 1] = 0;
}

// Returns the largest magnitude times weight in a row.
FJR_VECTORISED double largest_of(const double* row, const double* weights, int width) {
  Lanes largest{};
  for (int w = 0; w < width; w += kLanes) {
    Lanes size = *reinterpret_cast<const Lanes*>(row + w);
    make_magnitude(size);
    keep_larger(largest, size * *reinterpret_cast<const Lanes*>(weights + w));
  }
  return largest_lane(largest);
}

}  // namespace

void DenseLdlt::reset(std::span<const int> index) {
  index_.assign(index.begin(), index.end());
  matrix_.resize(order(), order());
  d_.assign(index_.size(), 0);
  e_.assign(index_.size(), 0);
  weights_.resize_to_zero(1, order());
  judge_as_is(0);
  pivots_ = 0;
}

// Makes the pivot tests use the matrix without scaling.
void DenseLdlt::judge_as_is(int first) { std::fill(weights_.row(0) + first, weights_.row(0) + order(), 1.0); }

// Makes the pivot tests use the matrix scaled so that no entry exceeds 1 and nearly every row has an entry 1 (Bunch,
// Numer. Math. 17, 1971). The row of an active constraint has entries of size 1 and almost zero on its diagonal, while
// the columns of states near their bounds are of size 1e10; the choice of pivots should not depend on such units.
void DenseLdlt::judge_scaled(int first) {
  double* weights = weights_.row(0);
  std::fill(weights + first, weights + order(), 0.0);
  for (int i = first; i < order(); ++i) {
    const double size = std::max(std::sqrt(std::fabs(row(i)[i])), largest_of(row(i), weights, matrix_.width()));
    weights[i] = size > 0 ? 1 / size : 1;
  }
}

// Returns the largest scaled magnitude in row i of the part that is not eliminated, without columns c and d.
double DenseLdlt::largest(int i, int c, int d) {
  double* weights = weights_.row(0);
  const double of_i = weights[i], of_c = weights[c], of_d = weights[d];
  weights[c] = weights[d] = 0;
  const double result = of_i * largest_of(row(i), weights, matrix_.width());
  weights[c] = of_c;
  weights[d] = of_d;
  return result;
}

// Exchanges rows and columns p and q, neither eliminated yet.
void DenseLdlt::exchange(int p, int q) {
  if (p == q) return;
  std::swap_ranges(row(p), row(p) + matrix_.width(), row(q));
  for (int i = 0; i < order(); ++i) std::swap(row(i)[p], row(i)[q]);
  std::swap(index_[static_cast<std::size_t>(p)], index_[static_cast<std::size_t>(q)]);
  std::swap(weights_.row(0)[p], weights_.row(0)[q]);
}

double DenseLdlt::scaled(int i, int j) const { return row(i)[j] * weights_.row(0)[i] * weights_.row(0)[j]; }

// Returns whether row c alone is a stable pivot.
bool DenseLdlt::is_stable(int c, double wanted) {
  return std::fabs(row(c)[c]) > kZero && std::fabs(scaled(c, c)) >= wanted * largest(c, c, c);
}

// Returns whether rows c and r together are a stable pivot. The entries of the inverse pivot times the remaining
// entries are bounded row by row (the test of Duff & Reid).
bool DenseLdlt::is_stable(int c, int r, double wanted) {
  const double x = scaled(c, c), y = scaled(c, r), z = scaled(r, r), determinant = x * z - y * y;
  const double off_c = largest(c, c, r), off_r = largest(r, c, r);
  const double growth =
      std::max(std::fabs(z) * off_c + std::fabs(y) * off_r, std::fabs(y) * off_c + std::fabs(x) * off_r);
  return std::fabs(determinant) > kZero && growth * wanted <= std::fabs(determinant);
}

// Returns the candidate from row `first` on with the largest scaled entry in row c; -1 if all are zero.
int DenseLdlt::partner_of(int c, int first, int candidates) const {
  int r = -1;
  double most = 0;
  for (int j = first; j < candidates; ++j) {
    if (j == c || std::fabs(scaled(c, j)) <= most) continue;
    most = std::fabs(scaled(c, j));
    r = j;
  }
  return r;
}

// Eliminates row c as pivot p. Returns the number of its negative eigenvalues.
int DenseLdlt::eliminate_one(int p, int c) {
  exchange(p, c);
  const double d = row(p)[p];
  d_[static_cast<std::size_t>(p)] = d;
  subtract_one(matrix_.data(), order(), matrix_.width(), p, d);
  weights_.row(0)[p] = 0;
  return d < 0;
}

// Eliminates rows c and r as pivots p and p + 1. Returns the number of their negative eigenvalues.
int DenseLdlt::eliminate_two(int p, int c, int r) {
  exchange(p, c);
  exchange(p + 1, r == p ? c : r);
  const double d0 = row(p)[p], e0 = row(p)[p + 1], d1 = row(p + 1)[p + 1], determinant = d0 * d1 - e0 * e0;
  d_[static_cast<std::size_t>(p)] = d0;
  d_[static_cast<std::size_t>(p) + 1] = d1;
  e_[static_cast<std::size_t>(p)] = e0;
  subtract_two(matrix_.data(), order(), matrix_.width(), p, d0, e0, d1);
  weights_.row(0)[p] = weights_.row(0)[p + 1] = 0;
  return determinant < 0 ? 1 : (d0 < 0 ? 2 : 0);
}

int DenseLdlt::eliminate(int candidates, double threshold) {
  // The scaled matrix is tried last, because a delayed row often finds a better pivot in a later block.
  const struct {
    double wanted;
    bool scaled;
  } judgements[] = {{kComfortable, false}, {threshold, false}, {kComfortable, true}, {threshold, true}};
  const auto* judgement = std::begin(judgements);
  int negative = 0, p = 0, candidate = 0;
  const auto begin_again_at = [&](int next) {
    p = next;
    candidate = 0;
    if (judgement->scaled) judge_as_is(p);
    judgement = std::begin(judgements);
  };
  while (p < candidates) {
    if (p + candidate >= candidates) {  // no candidate passes this test
      if (++judgement == std::end(judgements)) break;
      if (judgement->scaled && candidates - p <= kMostWaiting) break;
      if (judgement->scaled) judge_scaled(p);
      candidate = 0;
    }
    const int c = p + candidate;
    if (is_stable(c, judgement->wanted)) {
      negative += eliminate_one(p, c);
      begin_again_at(p + 1);
      continue;
    }
    const int r = partner_of(c, p, candidates);
    if (r >= 0 && is_stable(c, r, judgement->wanted)) {
      negative += eliminate_two(p, c, r);
      begin_again_at(p + 2);
      continue;
    }
    ++candidate;
  }
  pivots_ = p;
  return negative;
}

void DenseLdlt::solve_forward(std::span<double> x) const {
  for (int p = 0; p < pivots_; ++p) {
    const double* l = row(p);
    const double pivot = x[static_cast<std::size_t>(p)];
    const int below = e_[static_cast<std::size_t>(p)] != 0 ? p + 2 : p + 1;
    for (int i = below; i < order(); ++i) x[static_cast<std::size_t>(i)] -= l[i] * pivot;
  }
}

void DenseLdlt::solve_backward(std::span<double> x) const {
  for (std::size_t q = 0; q < static_cast<std::size_t>(pivots_); ++q) {
    if (e_[q] == 0) {
      x[q] /= d_[q];
      continue;
    }
    const double det = d_[q] * d_[q + 1] - e_[q] * e_[q], first = x[q], second = x[q + 1];
    x[q] = (d_[q + 1] * first - e_[q] * second) / det;
    x[q + 1] = (d_[q] * second - e_[q] * first) / det;
    ++q;
  }
  for (int p = pivots_ - 1; p >= 0; --p) {
    const double* l = row(p);
    const int below = e_[static_cast<std::size_t>(p)] != 0 ? p + 2 : p + 1;
    double value = x[static_cast<std::size_t>(p)];
    for (int i = below; i < order(); ++i) value -= l[i] * x[static_cast<std::size_t>(i)];
    x[static_cast<std::size_t>(p)] = value;
  }
}

}  // namespace fjr
