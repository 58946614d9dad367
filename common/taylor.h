// Truncated Taylor series in time: a scalar that carries its first derivatives exactly through any formula.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace fjr {

// c[k] = f^(k)(t0) / k! for k = 0 .. Order. Products and sums of series drop what lies beyond Order, so every kept
// coefficient is exact up to rounding: no step size, no truncation error.
template <std::size_t Order>
struct Taylor {
  std::array<double, Order + 1> c{};

  constexpr Taylor() = default;
  constexpr Taylor(double constant) { c[0] = constant; }  // NOLINT(google-explicit-constructor): a scalar is a series

  // From the value and the first derivatives f, f', f'', ...
  static constexpr Taylor from_derivatives(const std::array<double, Order + 1>& derivatives) {
    Taylor s;
    double factorial = 1;
    for (std::size_t k = 0; k <= Order; ++k) {
      if (k > 0) factorial *= static_cast<double>(k);
      s.c[k] = derivatives[k] / factorial;
    }
    return s;
  }

  // f^(k)(t0)
  constexpr double derivative(std::size_t k) const {
    double factorial = 1;
    for (std::size_t i = 2; i <= k; ++i) factorial *= static_cast<double>(i);
    return c[k] * factorial;
  }

  friend constexpr Taylor operator+(const Taylor& a, const Taylor& b) {
    Taylor r;
    for (std::size_t k = 0; k <= Order; ++k) r.c[k] = a.c[k] + b.c[k];
    return r;
  }
  friend constexpr Taylor operator-(const Taylor& a) {
    Taylor r;
    for (std::size_t k = 0; k <= Order; ++k) r.c[k] = -a.c[k];
    return r;
  }
  friend constexpr Taylor operator-(const Taylor& a, const Taylor& b) { return a + (-b); }

  friend constexpr Taylor operator*(const Taylor& a, const Taylor& b) {
    Taylor r;
    for (std::size_t k = 0; k <= Order; ++k) {
      for (std::size_t i = 0; i <= k; ++i) r.c[k] += a.c[i] * b.c[k - i];
    }
    return r;
  }

  // Solves r b = a, coefficient by coefficient. b.c[0] must not be zero.
  friend constexpr Taylor operator/(const Taylor& a, const Taylor& b) {
    Taylor r;
    for (std::size_t k = 0; k <= Order; ++k) {
      r.c[k] = a.c[k];
      for (std::size_t i = 0; i < k; ++i) r.c[k] -= r.c[i] * b.c[k - i];
      r.c[k] /= b.c[0];
    }
    return r;
  }

  Taylor& operator+=(const Taylor& b) { return *this = *this + b; }
  Taylor& operator-=(const Taylor& b) { return *this = *this - b; }
  Taylor& operator*=(const Taylor& b) { return *this = *this * b; }
  Taylor& operator/=(const Taylor& b) { return *this = *this / b; }
};

// Computes sine and cosine together, since each needs the other: s' = c a', c' = -s a'.
template <std::size_t Order>
struct SineCosine {
  Taylor<Order> sine, cosine;

  explicit SineCosine(const Taylor<Order>& a) {
    sine.c[0] = std::sin(a.c[0]);
    cosine.c[0] = std::cos(a.c[0]);
    for (std::size_t k = 1; k <= Order; ++k) {
      for (std::size_t i = 1; i <= k; ++i) {
        const double rate = static_cast<double>(i) * a.c[i] / static_cast<double>(k);
        sine.c[k] += rate * cosine.c[k - i];
        cosine.c[k] -= rate * sine.c[k - i];
      }
    }
  }
};

template <std::size_t Order>
Taylor<Order> sin(const Taylor<Order>& a) {
  return SineCosine<Order>(a).sine;
}

template <std::size_t Order>
Taylor<Order> cos(const Taylor<Order>& a) {
  return SineCosine<Order>(a).cosine;
}

}  // namespace fjr
