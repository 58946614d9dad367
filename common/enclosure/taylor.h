// Taylor coefficients of a recorded function along power series of its inputs: automatic differentiation, coefficient
// by coefficient. Moore, Kearfott & Cloud, Introduction to Interval Analysis, ch. 9; Griewank & Walther, Evaluating
// Derivatives, ch. 13 (recurrences of the elementary functions).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "common/enclosure/ball.h"
#include "common/enclosure/recording.h"

namespace enclosure {

// Coefficients 0 to `order` of every node.
class Series {
 public:
  Series(const Recording& f, std::size_t order)
      : f_(&f), stride_(order + 1), coefficients_(f.nodes().size() * stride_) {}

  const Recording& function() const { return *f_; }
  Ball& at(std::size_t node, std::size_t k) { return coefficients_[node * stride_ + k]; }
  const Ball& at(std::size_t node, std::size_t k) const { return coefficients_[node * stride_ + k]; }
  const Ball& output(std::size_t i, std::size_t k) const { return at(f_->outputs()[i], k); }

  // Computes coefficient k of every node. The lower coefficients, and those of the inputs up to k, must be set.
  void compute(std::size_t k) {
    const std::vector<Node>& nodes = f_->nodes();
    for (std::size_t i = f_->inputs(); i < nodes.size(); ++i) at(i, k) = coefficient(nodes[i], i, k);
  }

 private:
  Ball coefficient(const Node& n, std::size_t i, std::size_t k) const {
    switch (n.op) {
      case Op::kInput:
        break;
      case Op::kConstant:
        return k == 0 ? n.constant : Ball{};
      case Op::kAdd:
        return at(n.a, k) + at(n.b, k);
      case Op::kSubtract:
        return at(n.a, k) - at(n.b, k);
      case Op::kScale:
        return at(n.a, k) * n.constant;
      case Op::kShift:
        return k == 0 ? at(n.a, 0) + n.constant : at(n.a, k);
      case Op::kMultiply:
        return k == 0 && n.a == n.b ? square(at(n.a, 0)) : product(n.a, n.b, k);
      case Op::kDivide:
        return quotient(n, i, k);
      case Op::kSine:
        return k == 0 ? sin(at(n.a, 0)) : integral(n.a, i + 1, k);
      case Op::kCosine:
        return k == 0 ? cos(at(n.a, 0)) : -integral(n.a, i - 1, k);
      case Op::kTanh:
        return k == 0 ? tanh(at(n.a, 0)) : integral(n.a, i + 2, k);
      case Op::kTanhRate:  // coefficient k - 1 of t a'
        return rate(n.a, i - 1, k, 1);
      case Op::kSech2:  // w' = -2 t a' w: in proportion to w, however small that is
        return k == 0 ? sech2(at(n.a, 0)) : -2.0 * product(i - 1, i, k, 1, static_cast<double>(k));
      case Op::kExp:
        return k == 0 ? exp(at(n.a, 0)) : integral(n.a, i, k);
    }
    return at(i, k);
  }
  // sum_(j >= first) a_j b_(k-j) / divisor
  Ball product(std::size_t a, std::size_t b, std::size_t k, std::size_t first = 0, double divisor = 1) const {
    SumOfProducts sum;
    for (std::size_t j = first; j <= k; ++j) sum.add(at(a, j), at(b, k - j));
    return sum.total(divisor);
  }
  // sum_j j a_j w_(k-j) / divisor: coefficient k - 1 of a' w, or with k as divisor coefficient k of its integral.
  Ball rate(std::size_t a, std::size_t w, std::size_t k, double divisor) const {
    SumOfProducts sum;
    for (std::size_t j = 1; j <= k; ++j) sum.add(at(a, j), at(w, k - j), static_cast<double>(j));
    return sum.total(divisor);
  }
  // Of g, where g' = a' w.
  Ball integral(std::size_t a, std::size_t w, std::size_t k) const { return rate(a, w, k, static_cast<double>(k)); }
  // q b = a.
  Ball quotient(const Node& n, std::size_t i, std::size_t k) const {
    SumOfProducts sum;
    for (std::size_t j = 1; j <= k; ++j) sum.add(at(n.b, j), at(i, k - j));
    return (at(n.a, k) - sum.total()) / at(n.b, 0);
  }

  const Recording* f_;
  std::size_t stride_;
  std::vector<Ball> coefficients_;
};

// A ball for each of N directions, stored as separate arrays of middles and radii for fast loops.
template <std::size_t N>
struct Slope {
  std::array<double, N> mid{}, rad{};

  Ball operator[](std::size_t j) const { return {mid[j], rad[j]}; }
  void set(std::size_t j, const Ball& b) {
    mid[j] = b.mid;
    rad[j] = b.rad;
  }
};

// Derivatives in N directions of the coefficients of a Series: the same recurrences, differentiated.
template <std::size_t N>
class Slopes {
 public:
  Slopes(const Recording& f, std::size_t order) : stride_(order + 1), coefficients_(f.nodes().size() * stride_) {}

  Slope<N>& at(std::size_t node, std::size_t k) { return coefficients_[node * stride_ + k]; }
  const Slope<N>& at(std::size_t node, std::size_t k) const { return coefficients_[node * stride_ + k]; }

  // Computes coefficient k of every node. The lower ones, and those of `values` up to k, must be set.
  void compute(const Series& values, std::size_t k) {
    const std::vector<Node>& nodes = values.function().nodes();
    for (std::size_t i = values.function().inputs(); i < nodes.size(); ++i) coefficient(nodes[i], i, k, values);
  }

 private:
  // sum_i w_i c_i g_i of balls c and slopes g. A sum of n products of doubles is off by (n + 1) kUnit of the sum of
  // magnitudes; kMany bounds that for the orders there are.
  struct Sum {
    static constexpr double kMany = 128 * kUnit;
    std::array<double, N> mid{}, rad{};

    void add(const Ball& c, const Slope<N>& g, double weight = 1) {
      const double m = weight * c.mid, size = std::abs(m), r = std::abs(weight) * c.rad, wide = size * (1 + kMany) + r;
      const double exact = size * kMany + r;
      for (std::size_t j = 0; j < N; ++j) {
        mid[j] += m * g.mid[j];
        rad[j] += wide * g.rad[j] + exact * std::abs(g.mid[j]);
      }
    }
    void add(const Slope<N>& g) { add(Ball(1), g); }
    void write(Slope<N>& to) const {
      for (std::size_t j = 0; j < N; ++j) {
        to.mid[j] = mid[j];
        to.rad[j] = rad[j] * (1 + kMany) + kUnderflow;
      }
    }
    void write(Slope<N>& to, const Ball& factor) const {
      Slope<N> before;
      write(before);
      Sum scaled;
      scaled.add(factor, before);
      scaled.write(to);
    }
  };

  void coefficient(const Node& n, std::size_t i, std::size_t k, const Series& v) {
    Sum sum;
    Slope<N>& out = at(i, k);
    switch (n.op) {
      case Op::kInput:
        return;
      case Op::kConstant:
        break;
      case Op::kAdd:
        sum.add(at(n.a, k));
        sum.add(at(n.b, k));
        break;
      case Op::kSubtract:
        sum.add(at(n.a, k));
        sum.add(-1.0, at(n.b, k));
        break;
      case Op::kScale:
        sum.add(n.constant, at(n.a, k));
        break;
      case Op::kShift:
        out = at(n.a, k);
        return;
      case Op::kMultiply:
        add_product(sum, n.a, n.b, k, v, 1);
        break;
      case Op::kDivide:
        sum.add(at(n.a, k));
        for (std::size_t j = 0; j <= k; ++j) {
          if (j > 0) sum.add(v.at(n.b, j), at(i, k - j), -1);
          sum.add(v.at(i, k - j), at(n.b, j), -1);
        }
        sum.write(out, Ball(1) / v.at(n.b, 0));
        return;
      case Op::kSine:
        return integral(n.a, i + 1, k, v, 1, out);
      case Op::kTanh:
        return integral(n.a, i + 2, k, v, 1, out);
      case Op::kTanhRate:
        add_rate(sum, n.a, i - 1, k, v, 1);
        break;
      case Op::kCosine:
        return integral(n.a, i - 1, k, v, -1, out);
      case Op::kExp:
        return integral(n.a, i, k, v, 1, out);
      case Op::kSech2:
        if (k == 0) {
          sum.add(v.at(i - 2, 0) * v.at(i, 0), at(n.a, 0), -2);
          break;
        }
        add_product(sum, i - 1, i, k, v, -2, 1);
        return sum.write(out, Ball(1) / Ball(static_cast<double>(k)));
    }
    sum.write(out);
  }
  void add_product(Sum& sum, std::size_t a, std::size_t b, std::size_t k, const Series& v, double factor,
                   std::size_t first = 0) const {
    for (std::size_t j = first; j <= k; ++j) {
      sum.add(v.at(a, j), at(b, k - j), a == b ? 2 * factor : factor);
      if (a != b) sum.add(v.at(b, k - j), at(a, j), factor);
    }
  }
  void add_rate(Sum& sum, std::size_t a, std::size_t w, std::size_t k, const Series& v, double sign) const {
    for (std::size_t j = 1; j <= k; ++j) {
      const double weight = sign * static_cast<double>(j);
      sum.add(v.at(w, k - j), at(a, j), weight);
      sum.add(v.at(a, j), at(w, k - j), weight);
    }
  }
  void integral(std::size_t a, std::size_t w, std::size_t k, const Series& v, double sign, Slope<N>& out) const {
    Sum sum;
    if (k == 0) {
      sum.add(v.at(w, 0), at(a, 0), sign);
      return sum.write(out);
    }
    add_rate(sum, a, w, k, v, sign);
    sum.write(out, Ball(1) / Ball(static_cast<double>(k)));
  }

  std::size_t stride_;
  std::vector<Slope<N>> coefficients_;
};

}  // namespace enclosure
