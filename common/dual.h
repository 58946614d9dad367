// Scalars that carry exact derivatives, and one that carries only their structure.
//
// A function templated on its scalar gives, called with
//   Dual<N>    its value and gradient in N inputs,
//   Dual2<N>   its value, gradient and Hessian,
//   Pattern<N> which entries of the gradient and of the Hessian can ever be non-zero.
// Every elementary function is one line: its value, first and second derivative, through chain().
// Griewank & Walther, Evaluating Derivatives, ch. 3 and 7 (forward mode).
#pragma once

#include <algorithm>
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

// A stretch of inputs, from first to end - 1.
struct Support {
  std::size_t first = 64, end = 0;  // none
  friend Support operator|(Support a, Support b) { return {std::min(a.first, b.first), std::max(a.end, b.end)}; }
};

// Hessian entries are packed by rows of the lower triangle: (i, j <= i) at i (i + 1) / 2 + j. The function depends only
// on the inputs in `sees`, and is linear in all except those in `curved`. Derivatives that are zero for these reasons
// cost no time: of ten inputs, sin(q2) depends on one, and a spring torque is linear in all.
template <int N>
struct Dual2 {
  static_assert(N <= 64);
  static constexpr int kInputs = N;
  static constexpr std::size_t kHessian = N * (N + 1) / 2;
  double v = 0;
  Support sees, curved;
  std::array<double, N> g{};
  std::array<double, kHessian> h;  // undefined outside `curved`

  Dual2() = default;
  Dual2(double value) : v(value) {}  // NOLINT(google-explicit-constructor)
  // Starts with zero derivatives, to which others are added.
  Dual2(double value, Support sees_, Support curved_) : v(value), sees(sees_), curved(curved_) {
    if (curved.first < curved.end) std::fill_n(h.data() + row(curved.first), row(curved.end) - row(curved.first), 0.0);
  }
  // Copies only the defined entries of h, because most are undefined.
  Dual2(const Dual2& other) : v(other.v), sees(other.sees), curved(other.curved), g(other.g) { copy_hessian(other); }
  Dual2& operator=(const Dual2& other) {
    v = other.v;
    sees = other.sees;
    curved = other.curved;
    g = other.g;
    copy_hessian(other);
    return *this;
  }
  static Dual2 input(double value, int i) {
    const auto at = static_cast<std::size_t>(i);
    Dual2 d(value, {at, at + 1}, {});
    d.g[at] = 1;
    return d;
  }

  static constexpr std::size_t row(std::size_t i) { return i * (i + 1) / 2; }
  double second(std::size_t i, std::size_t j) const {
    const auto [low, high] = std::minmax(i, j);
    return low >= curved.first && high < curved.end ? h[row(high) + low] : 0.0;
  }

  // visit(i, j, index) for the stored entries of h.
  template <class Visit>
  void each(Visit&& visit) const {
    for (std::size_t i = curved.first; i < curved.end; ++i) {
      for (std::size_t j = curved.first; j <= i; ++j) visit(i, j, row(i) + j);
    }
  }
  // Adds s d to the derivatives. The supports of d must lie within those of this.
  void accumulate(double s, const Dual2& d) {
    for (std::size_t i = d.sees.first; i < d.sees.end; ++i) g[i] += s * d.g[i];
    d.each([&](std::size_t, std::size_t, std::size_t at) { h[at] += s * d.h[at]; });
  }
  // Adds s times the contribution of the gradients of a and b to the Hessian of a b.
  void accumulate_product(double s, const Dual2& a, const Dual2& b) {
    for (std::size_t i = a.sees.first; i < a.sees.end; ++i) {
      for (std::size_t j = b.sees.first; j < b.sees.end; ++j) {
        const double product = s * a.g[i] * b.g[j];
        i > j ? h[row(i) + j] += product : h[row(j) + i] += i == j ? 2 * product : product;
      }
    }
  }

 private:
  void copy_hessian(const Dual2& other) {
    if (curved.first >= curved.end) return;
    std::copy(other.h.data() + row(curved.first), other.h.data() + row(curved.end), h.data() + row(curved.first));
  }
};

template <class D>
concept Differentiable = requires {
  D::kInputs;
};

// Scalars that carry a value, which closed forms need; a Pattern does not.
template <class D>
inline constexpr bool kHasFirst = false;
template <int N>
inline constexpr bool kHasFirst<Dual<N>> = true;
template <class D>
inline constexpr bool kHasSecond = false;
template <int N>
inline constexpr bool kHasSecond<Dual2<N>> = true;
template <class D>
concept CarriesValues = kHasFirst<D> || kHasSecond<D>;

// F(a) with derivatives: value f, first derivative f1, second derivative f2 at a.v.
template <int N>
Dual<N> chain(const Dual<N>& a, double f, double f1, double /*f2*/) {
  Dual<N> r(f);
  for (std::size_t i = 0; i < N; ++i) r.g[i] = f1 * a.g[i];
  return r;
}

template <int N>
Dual2<N> chain(const Dual2<N>& a, double f, double f1, double f2) {
  Dual2<N> r(f, a.sees, a.sees);
  r.accumulate(f1, a);
  r.each([&](std::size_t i, std::size_t j, std::size_t at) { r.h[at] += f2 * a.g[i] * a.g[j]; });
  return r;
}

// F(a_1 .. a_M) with derivatives: value f, gradient f1, Hessian f2 packed by rows of the lower triangle, at their
// values.
template <int N, std::size_t M>
Dual<N> chain(const std::array<const Dual<N>*, M>& a, double f, const std::array<double, M>& f1,
              const std::array<double, M*(M + 1) / 2>& /*f2*/) {
  Dual<N> r(f);
  for (std::size_t k = 0; k < M; ++k) {
    for (std::size_t i = 0; i < N; ++i) r.g[i] += f1[k] * a[k]->g[i];
  }
  return r;
}

template <int N, std::size_t M>
Dual2<N> chain(const std::array<const Dual2<N>*, M>& a, double f, const std::array<double, M>& f1,
               const std::array<double, M*(M + 1) / 2>& f2) {
  Support all;
  for (const auto* input : a) all = all | input->sees;
  Dual2<N> r(f, all, all);
  for (std::size_t k = 0, pair = 0; k < M; ++k) {
    r.accumulate(f1[k], *a[k]);
    for (std::size_t l = 0; l <= k; ++l, ++pair) {
      if (f2[pair] != 0) r.accumulate_product(l == k ? 0.5 * f2[pair] : f2[pair], *a[k], *a[l]);
    }
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
  Dual2<N> r(a.v + s * b.v, a.sees | b.sees, a.curved | b.curved);
  r.accumulate(1, a);
  r.accumulate(s, b);
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
  const Support both = a.sees | b.sees;
  Dual2<N> r(a.v * b.v, both, both);
  r.accumulate(b.v, a);
  r.accumulate(a.v, b);
  r.accumulate_product(1, a, b);
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
template <int N>
Dual2<N> scaled(const Dual2<N>& a, double s) {
  Dual2<N> r(s * a.v, a.sees, a.curved);
  r.accumulate(s, a);
  return r;
}
template <Differentiable D>
D shifted(D a, double s) {
  a.v += s;
  return a;
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
  return shifted(a, b);
}
template <Differentiable D>
D operator+(double a, const D& b) {
  return shifted(b, a);
}
template <Differentiable D>
D operator-(const D& a, double b) {
  return shifted(a, -b);
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
