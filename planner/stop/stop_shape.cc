#include "planner/stop/stop_shape.h"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace fjr {
namespace {

constexpr int kBasis = 5 + kShapes;
constexpr int kCoefficients = 10 + kShapes;  // degree 9, and bumps of degree 10 and more
using Polynomial = std::array<double, kCoefficients>;

// Returns d^k/ds^k of s^i at s = 1: i (i - 1) ... (i - k + 1).
double falling(int i, int k) {
  double product = 1;
  for (int r = 0; r < k; ++r) product *= i - r;
  return product;
}

double derivative(const Polynomial& p, int k, double s) {
  double value = 0;
  for (int i = kCoefficients - 1; i >= k; --i) value = value * s + falling(i, k) * p[static_cast<std::size_t>(i)];
  return value;
}

// Returns the polynomial of degree 9 with q and four derivatives `start` at s = 0, and with the value `end` and four
// zero derivatives at s = 1.
Polynomial from_ends(const Derivatives& start, double end) {
  Polynomial p{};
  Eigen::Matrix<double, 5, 5> a;
  Eigen::Matrix<double, 5, 1> rest;
  for (int i = 0; i < 5; ++i) p[static_cast<std::size_t>(i)] = start[static_cast<std::size_t>(i)] / falling(i, i);
  for (int k = 0; k < 5; ++k) {
    rest(k) = (k == 0 ? end : 0) - derivative(p, k, 1);
    for (int i = 5; i < 10; ++i) a(k, i - 5) = falling(i, k);
  }
  const Eigen::Matrix<double, 5, 1> x = a.partialPivLu().solve(rest);
  for (int i = 5; i < 10; ++i) p[static_cast<std::size_t>(i)] = x(i - 5);
  return p;
}

// Returns the Legendre polynomial P_n(2s-1), by (n+1) P_n+1 = (2n+1) (2s-1) P_n - n P_n-1.
Polynomial legendre(int n) {
  Polynomial before{}, now{};
  now[0] = 1;
  for (int k = 0; k < n; ++k) {
    Polynomial next{};
    for (std::size_t i = 0; i < next.size(); ++i) {
      const double shifted = i > 0 ? 2 * now[i - 1] : 0;
      next[i] = ((2 * k + 1) * (shifted - now[i]) - k * before[i]) / (k + 1);
    }
    before = now;
    now = next;
  }
  return now;
}

Polynomial bump(int n) {
  constexpr std::array<double, 6> kRising{1, -5, 10, -10, 5, -1};  // (1-s)^5
  constexpr double kScale = 1024;                                  // 1 / (s^5 (1-s)^5) at s = 1/2
  const Polynomial p = legendre(n);
  Polynomial b{};
  for (std::size_t i = 0; i < kShapes; ++i) {
    for (std::size_t k = 0; k < kRising.size() && 5 + i + k < b.size(); ++k) b[5 + i + k] += kScale * kRising[k] * p[i];
  }
  return b;
}

std::array<Polynomial, kBasis> make_basis() {
  std::array<Polynomial, kBasis> basis;
  for (std::size_t i = 0; i < 5; ++i) {
    Derivatives start{};
    start[i] = 1;
    basis[i] = from_ends(start, i == 0 ? 1 : 0);  // a shift in q shifts the end as well
  }
  basis[5] = from_ends({}, 1);
  for (int n = 0; n + 1 < kShapes; ++n) basis[static_cast<std::size_t>(6 + n)] = bump(n);
  return basis;
}

const std::array<Polynomial, kBasis>& basis() {
  static const std::array<Polynomial, kBasis> made = make_basis();
  return made;
}

double weight(const StopShape& shape, std::size_t i) { return i < 5 ? shape.start[i] : shape.free[i - 5]; }

}  // namespace

ShapeTable::ShapeTable(int nodes) : rows_(static_cast<std::size_t>(nodes) + 1) {
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    const double s = 0.5 - 0.5 * std::cos(std::numbers::pi * static_cast<double>(n) / nodes);
    for (std::size_t i = 0; i < kBasis; ++i) {
      for (int k = 0; k < 5; ++k) rows_[n].value[i][static_cast<std::size_t>(k)] = derivative(basis()[i], k, s);
    }
  }
}

Derivatives ShapeTable::at(const StopShape& shape, int node) const {
  const Row& row = rows_[static_cast<std::size_t>(node)];
  Derivatives d{};
  for (std::size_t i = 0; i < kBasis; ++i) {
    for (std::size_t k = 0; k < d.size(); ++k) d[k] += weight(shape, i) * row.value[i][k];
  }
  return d;
}

Derivatives evaluate(const StopShape& shape, double s) {
  Derivatives d{};
  for (std::size_t i = 0; i < kBasis; ++i) {
    for (int k = 0; k < 5; ++k) d[static_cast<std::size_t>(k)] += weight(shape, i) * derivative(basis()[i], k, s);
  }
  return d;
}

LinkMotion in_time(const Joints<Derivatives>& derivatives, double duration) {
  LinkMotion m;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double h = duration;
    m.q[j] = derivatives[j][0];
    m.dq[j] = derivatives[j][1] / h;
    m.ddq[j] = derivatives[j][2] / (h * h);
    m.dddq[j] = derivatives[j][3] / (h * h * h);
    m.ddddq[j] = derivatives[j][4] / (h * h * h * h);
  }
  return m;
}

Joints<StopShape> shapes_from(const LinkMotion& m, double duration) {
  Joints<StopShape> shapes;
  const double h = duration;
  for (std::size_t j = 0; j < kJoints; ++j) {
    shapes[j].start = {m.q[j], m.dq[j] * h, m.ddq[j] * h * h, m.dddq[j] * h * h * h, m.ddddq[j] * h * h * h * h};
  }
  return shapes;
}

}  // namespace fjr
