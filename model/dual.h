// Scalars that carry exact derivatives, and one that carries only their structure.
//
// A function templated on its scalar gives, called with
//   Dual<N>    its value and gradient in N inputs,
//   Dual2<N>   its value, gradient and Hessian,
//   Pattern<N> which entries of the gradient and of the Hessian can ever be non-zero.
// Every elementary function is one line: its value, first and second derivative, through chain().
// Griewank & Walther, Evaluating Derivatives, ch. 3 and 7 (forward mode).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace fjr {

template <int N>
struct Dual {
  static constexpr int kInputs = N;
  double v = 0;
  std::array<double, N> g{};

  Dual() = default;
  Dual(double value) : v(value) {}  // NOLINT(google-explicit-constructor): constants mix freely with active values
  static Dual input(double value, int i) {
    Dual d(value);
    d.g[static_cast<std::size_t>(i)] = 1;
    return d;
  }
};

// Hessian entries are packed by rows of the lower triangle: (i, j <= i) at i (i + 1) / 2 + j.
template <int N>
struct Dual2 {
  static constexpr int kInputs = N;
  static constexpr int kHessian = N * (N + 1) / 2;
  double v = 0;
  std::array<double, N> g{};
  std::array<double, kHessian> h{};

  Dual2() = default;
  Dual2(double value) : v(value) {}  // NOLINT(google-explicit-constructor)
  static Dual2 input(double value, int i) {
    Dual2 d(value);
    d.g[static_cast<std::size_t>(i)] = 1;
    return d;
  }
};

template <class D>
concept Differentiable = requires {
  D::kInputs;
};

// F(a) with derivatives: value f, first derivative f1, second derivative f2 at a.v.
template <int N>
Dual<N> chain(const Dual<N>& a, double f, double f1, double /*f2*/) {
  Dual<N> r(f);
  for (std::size_t i = 0; i < N; ++i) r.g[i] = f1 * a.g[i];
  return r;
}

template <int N>
Dual2<N> chain(const Dual2<N>& a, double f, double f1, double f2) {
  Dual2<N> r(f);
  std::size_t k = 0;
  for (std::size_t i = 0; i < N; ++i) {
    const double scaled = f2 * a.g[i];
    for (std::size_t j = 0; j <= i; ++j, ++k) r.h[k] = f1 * a.h[k] + scaled * a.g[j];
    r.g[i] = f1 * a.g[i];
  }
  return r;
}

// a + s b
template <int N>
Dual<N> add(const Dual<N>& a, double s, const Dual<N>& b) {
  Dual<N> r(a.v + s * b.v);
  for (std::size_t i = 0; i < N; ++i) r.g[i] = a.g[i] + s * b.g[i];
  return r;
}

template <int N>
Dual2<N> add(const Dual2<N>& a, double s, const Dual2<N>& b) {
  Dual2<N> r(a.v + s * b.v);
  for (std::size_t i = 0; i < N; ++i) r.g[i] = a.g[i] + s * b.g[i];
  for (std::size_t k = 0; k < a.h.size(); ++k) r.h[k] = a.h[k] + s * b.h[k];
  return r;
}

template <int N>
Dual<N> operator*(const Dual<N>& a, const Dual<N>& b) {
  Dual<N> r(a.v * b.v);
  for (std::size_t i = 0; i < N; ++i) r.g[i] = a.v * b.g[i] + b.v * a.g[i];
  return r;
}

template <int N>
Dual2<N> operator*(const Dual2<N>& a, const Dual2<N>& b) {
  Dual2<N> r(a.v * b.v);
  std::size_t k = 0;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j <= i; ++j, ++k) {
      r.h[k] = a.v * b.h[k] + b.v * a.h[k] + a.g[i] * b.g[j] + a.g[j] * b.g[i];
    }
    r.g[i] = a.v * b.g[i] + b.v * a.g[i];
  }
  return r;
}

// Bit i of g: depends on input i. Bit j of h[i]: curved in the pair (i, j); symmetric.
template <int N>
struct Pattern {
  static_assert(N <= 32);
  static constexpr int kInputs = N;
  double v = 1;  // an arbitrary value, for the signature only
  std::uint32_t g = 0;
  std::array<std::uint32_t, N> h{};

  Pattern() = default;
  Pattern(double) {}  // NOLINT(google-explicit-constructor)
  static Pattern input(double, int i) {
    Pattern p;
    p.g = 1U << i;
    return p;
  }
  bool depends_on(int i) const { return (g >> i & 1U) != 0; }
  bool curved_in(int i, int j) const { return (h[static_cast<std::size_t>(i)] >> j & 1U) != 0; }
};

template <int N>
Pattern<N> add(const Pattern<N>& a, double, const Pattern<N>& b) {
  Pattern<N> r;
  r.g = a.g | b.g;
  for (std::size_t i = 0; i < N; ++i) r.h[i] = a.h[i] | b.h[i];
  return r;
}

template <int N>
Pattern<N> operator*(const Pattern<N>& a, const Pattern<N>& b) {
  Pattern<N> r = add(a, 1, b);
  for (std::size_t i = 0; i < N; ++i) {
    if (a.g >> i & 1U) r.h[i] |= b.g;
    if (b.g >> i & 1U) r.h[i] |= a.g;
  }
  return r;
}

template <int N>
Pattern<N> chain(const Pattern<N>& a, double, double, double) {
  return a * a;
}

// What follows is the same for all three. A product with a constant is linear: its own rule keeps patterns tight.
template <Differentiable D>
D scaled(const D& a, double s) {
  return add(D(0.0), s, a);
}
template <Differentiable D>
D operator+(const D& a, const D& b) {
  return add(a, 1, b);
}
template <Differentiable D>
D operator-(const D& a, const D& b) {
  return add(a, -1, b);
}
template <Differentiable D>
D operator-(const D& a) {
  return scaled(a, -1);
}
template <Differentiable D>
D operator+(const D& a, double b) {
  return add(a, 1, D(b));
}
template <Differentiable D>
D operator+(double a, const D& b) {
  return add(b, 1, D(a));
}
template <Differentiable D>
D operator-(const D& a, double b) {
  return add(a, -1, D(b));
}
template <Differentiable D>
D operator-(double a, const D& b) {
  return add(D(a), -1, b);
}
template <Differentiable D>
D operator*(const D& a, double b) {
  return scaled(a, b);
}
template <Differentiable D>
D operator*(double a, const D& b) {
  return scaled(b, a);
}
template <Differentiable D>
D inverse(const D& a) {
  const double r = 1 / a.v;
  return chain(a, r, -r * r, 2 * r * r * r);
}
template <Differentiable D>
D operator/(const D& a, const D& b) {
  return a * inverse(b);
}
template <Differentiable D>
D operator/(double a, const D& b) {
  return a * inverse(b);
}
template <Differentiable D>
D operator/(const D& a, double b) {
  return scaled(a, 1 / b);
}
template <Differentiable D>
D& operator+=(D& a, const D& b) {
  return a = a + b;
}
template <Differentiable D>
D& operator-=(D& a, const D& b) {
  return a = a - b;
}
template <Differentiable D>
D& operator*=(D& a, const D& b) {
  return a = a * b;
}

template <Differentiable D>
D sin(const D& a) {
  const double s = std::sin(a.v), c = std::cos(a.v);
  return chain(a, s, c, -s);
}
template <Differentiable D>
D cos(const D& a) {
  const double s = std::sin(a.v), c = std::cos(a.v);
  return chain(a, c, -s, -c);
}
template <Differentiable D>
D tanh(const D& a) {
  const double t = std::tanh(a.v), t1 = 1 - t * t;
  return chain(a, t, t1, -2 * t * t1);
}
template <Differentiable D>
D exp(const D& a) {
  const double e = std::exp(a.v);
  return chain(a, e, e, e);
}
template <Differentiable D>
D sqrt(const D& a) {
  const double r = std::sqrt(a.v);
  return chain(a, r, 0.5 / r, -0.25 / (r * a.v));
}

}  // namespace fjr
