// Sets of states that can be transported by linear maps without wrapping them in boxes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "common/enclosure/ball.h"

namespace enclosure {

template <std::size_t N>
using Matrix = std::array<std::array<double, N>, N>;
template <std::size_t N>
using Balls = std::array<Ball, N>;
template <std::size_t N>
using BallMatrix = std::array<Balls<N>, N>;

template <std::size_t N>
BallMatrix<N> exactly(const Matrix<N>& m) {
  BallMatrix<N> balls;
  for (std::size_t i = 0; i < N; ++i) std::copy(m[i].begin(), m[i].end(), balls[i].begin());
  return balls;
}
template <std::size_t N>
Matrix<N> middle(const BallMatrix<N>& a) {
  Matrix<N> m;
  for (std::size_t i = 0; i < N; ++i) {
    std::transform(a[i].begin(), a[i].end(), m[i].begin(), [](const Ball& b) { return b.mid; });
  }
  return m;
}
template <std::size_t N>
Matrix<N> transposed(const Matrix<N>& a) {
  Matrix<N> t;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) t[i][j] = a[j][i];
  }
  return t;
}
template <std::size_t N>
BallMatrix<N> operator*(const BallMatrix<N>& a, const BallMatrix<N>& b) {
  BallMatrix<N> c;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) {
      SumOfProducts sum;
      for (std::size_t k = 0; k < N; ++k) sum.add(a[i][k], b[k][j]);
      c[i][j] = sum.total();
    }
  }
  return c;
}
template <std::size_t N>
bool is_bounded(const Balls<N>& a) {
  return std::all_of(a.begin(), a.end(), [](const Ball& b) { return b.is_bounded(); });
}
template <std::size_t N>
bool is_bounded(const BallMatrix<N>& a) {
  return std::all_of(a.begin(), a.end(), [](const Balls<N>& row) { return is_bounded(row); });
}

// Bounds of the components of a r for all |r_j| <= radius_j.
template <std::size_t N>
std::array<double, N> extents(const BallMatrix<N>& a, const std::array<double, N>& radius) {
  std::array<double, N> to{};
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) to[i] = rounded_up(to[i] + a[i][j].magnitude() * radius[j]);
  }
  return to;
}

// A matrix with orthonormal columns, up to rounding, that span one after the other those of `edges`, longest first:
// edges times lengths. Gram-Schmidt, twice for each.
template <std::size_t N>
Matrix<N> orthonormal(const Matrix<N>& edges, const std::array<double, N>& lengths) {
  const Matrix<N> columns = transposed(edges);
  const auto norm = [](const std::array<double, N>& v) {
    return std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
  };
  std::array<std::size_t, N> order;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return norm(columns[a]) * lengths[a] > norm(columns[b]) * lengths[b];
  });
  Matrix<N> found{};  // by rows
  std::size_t count = 0;
  const auto take = [&](std::array<double, N> v) {
    if (count == N) return;
    const double before = norm(v);
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t c = 0; c < count; ++c) {
        const double along = std::inner_product(v.begin(), v.end(), found[c].begin(), 0.0);
        for (std::size_t i = 0; i < N; ++i) v[i] -= along * found[c][i];
      }
    }
    const double after = norm(v);
    constexpr double kOwnDirection = 1e-10;  // what is left of an edge that has none is rounding
    if (!(after > kOwnDirection * before)) return;
    for (std::size_t i = 0; i < N; ++i) found[count][i] = v[i] / after;
    ++count;
  };
  for (const std::size_t j : order) take(columns[j]);
  for (std::size_t i = 0; i < N; ++i) {  // for edges without a direction of their own
    std::array<double, N> unit{};
    unit[i] = 1;
    take(unit);
  }
  return transposed(found);
}

// Converts bounds of q^T y to bounds of q^-1 y for a nearly orthonormal q. With q^T q = I + e and |e| <= defect in the
// maximum norm, they differ by at most defect / (1 - defect) of the largest. Returns false if q is not nearly
// orthonormal.
template <std::size_t N>
bool allow_for_defect(const Matrix<N>& q, std::array<double, N>& bounds) {
  const BallMatrix<N> unit = exactly(transposed(q)) * exactly(q);
  double defect = 0;
  for (std::size_t i = 0; i < N; ++i) {
    double row = 0;
    for (std::size_t j = 0; j < N; ++j) row = rounded_up(row + (unit[i][j] - Ball(i == j ? 1.0 : 0.0)).magnitude());
    defect = std::max(defect, row);
  }
  if (!(defect < 0.5)) return false;
  const double largest = *std::max_element(bounds.begin(), bounds.end());
  for (double& bound : bounds) bound = rounded_up(bound + 2 * defect * largest);
  return true;
}

// {center + scale (edges s + basis r) : |s_j| <= old_j, |r_j| <= young_j}. The edges are transported without wrapping,
// and may become arbitrarily flat. Errors (roundings, remainders, the width of the map) go into the second part. Its
// basis is orthonormal: the orthogonal factor of the transported basis. When the second part has outgrown the first, it
// becomes the first, so that the set is wrapped only a few times over a long motion. x_i is scale_i times the component
// here. The scales are units in which oscillations are circles, so that lengths and right angles are meaningful. They
// are powers of two, which cause no rounding.
// Lohner (1992); Mrozek & Zgliczynski, Annales Polonici Mathematici 74 (2000).
template <std::size_t N>
class Set {
 public:
  Set() : Set(Balls<N>{}) {}
  explicit Set(const Balls<N>& box) : Set(box, ones()) {}
  Set(const Balls<N>& box, const std::array<double, N>& scale) : scale_(scale) {
    for (std::size_t i = 0; i < N; ++i) {
      center_[i] = box[i].mid;
      edges_[i][i] = basis_[i][i] = 1;
      old_[i] = box[i].rad / scale_[i];
    }
  }

  const std::array<double, N>& center() const { return center_; }

  // Returns the smallest box around the set, up to rounding outwards.
  Balls<N> hull() const {
    const std::array<double, N> old = extents(exactly(edges_), old_), young = extents(exactly(basis_), young_);
    Balls<N> box;
    for (std::size_t i = 0; i < N; ++i) box[i] = {center_[i], rounded_up(scale_[i] * (old[i] + young[i]))};
    return box;
  }

  // Replaces the set by one that contains center + map (x - center()) for all its x, and all centers and maps in the
  // balls. Returns false if none is found.
  bool move(const Balls<N>& center, const BallMatrix<N>& map) {
    const BallMatrix<N> here = scaled(map), edges = here * exactly(edges_), moved = here * exactly(basis_);
    if (!is_bounded(center) || !is_bounded(edges) || !is_bounded(moved)) return false;
    edges_ = middle(edges);
    BallMatrix<N> rest{};  // what the middles leave, as the edges of a box
    for (std::size_t i = 0; i < N; ++i) {
      double left = center[i].rad / scale_[i];
      for (std::size_t j = 0; j < N; ++j) left = rounded_up(left + edges[i][j].rad * old_[j]);
      rest[i][i] = left;
      center_[i] = center[i].mid;
    }
    basis_ = orthonormal(middle(moved), young_);
    const BallMatrix<N> back = exactly(transposed(basis_));
    return set_young(extents(back * moved, young_), extents(back * rest, ones())) && (!outgrown() || rejuvenate());
  }

 private:
  bool set_young(const std::array<double, N>& a, const std::array<double, N>& b) {
    for (std::size_t i = 0; i < N; ++i) young_[i] = rounded_up(a[i] + b[i]);
    return allow_for_defect(basis_, young_);
  }
  bool outgrown() const {
    constexpr double kTimes = 10;
    const std::array<double, N> old = extents(exactly(edges_), old_), young = extents(exactly(basis_), young_);
    return *std::max_element(young.begin(), young.end()) > kTimes * *std::max_element(old.begin(), old.end());
  }
  // Wraps the first part in the second, which then becomes the first.
  bool rejuvenate() {
    if (!set_young(extents(exactly(transposed(basis_)) * exactly(edges_), old_), young_)) return false;
    old_ = young_;
    edges_ = basis_;
    young_.fill(0);
    return true;
  }

  static std::array<double, N> ones() {
    std::array<double, N> all;
    all.fill(1);
    return all;
  }
  BallMatrix<N> scaled(BallMatrix<N> map) const {
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t j = 0; j < N; ++j) {
        const double factor = scale_[j] / scale_[i];
        map[i][j] = {map[i][j].mid * factor, map[i][j].rad * factor};
      }
    }
    return map;
  }

  std::array<double, N> scale_, center_{}, old_{}, young_{};
  Matrix<N> edges_{}, basis_{};
};

}  // namespace enclosure
