// Rigorous arithmetic with balls: numbers known up to a radius. Stands by itself: only the standard library.
//
// A Ball {mid, rad} is the set of all reals within rad of mid. Every operation returns a ball that holds the exact
// results for all reals of its operands: "outward rounding" by bounds of the rounding errors, in the usual rounding to
// nearest. Nothing depends on switched rounding modes, which compilers move code across, so any number of threads
// may compute at once. A fused multiply-add rounds once where two roundings were allowed for: contraction is harmless.
//
// Assumptions, each held by tests/enclosure (ball_test.cc, alone.cmake):
// - IEEE 754 doubles, evaluated as doubles, without -ffast-math or parts of it (checked below at compile time);
// - rounding to nearest while balls are computed (RoundingToNearest sees to that, and restores what was there);
// - std::sin, cos, tanh and exp are off by at most kElementaryError of their value (glibc 2.36 documents 1 to 2 units
//   in the last place, 2.2e-16 each).
//
// A result that is not finite is the ball of all reals: is_bounded() is false, also for every result computed from it.
// Rump, Verification methods, Acta Numerica 19 (2010); Johansson, Arb, IEEE Trans. Computers 66(8), 2017.
#pragma once

#include <algorithm>
#include <cfenv>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <limits>

namespace enclosure {

// Parts of -ffast-math alone, too: sums in another order, products with reciprocals, no infinities.
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || \
    (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "error bounds do not hold with -ffast-math"
#endif
static_assert(std::numeric_limits<double>::is_iec559 && FLT_EVAL_METHOD == 0, "doubles that are computed as doubles");

inline constexpr double kUnit = 0x1p-53;             // largest relative error of one operation
inline constexpr double kElementaryError = 0x1p-51;  // of sin, cos, tanh and exp: 4 kUnit
inline constexpr double kLargest = 1e280;            // beyond, a ball counts as unbounded
inline constexpr double kUnderflow = 0x1p-400;       // exceeds all losses by underflow in one expression

// Sets rounding to nearest, and restores the previous mode in its destructor. The mode belongs to the calling thread.
class RoundingToNearest {
 public:
  RoundingToNearest() : before_(std::fegetround()) { std::fesetround(FE_TONEAREST); }
  ~RoundingToNearest() { std::fesetround(before_); }
  RoundingToNearest(const RoundingToNearest&) = delete;
  RoundingToNearest& operator=(const RoundingToNearest&) = delete;

 private:
  int before_;
};

// Returns an upper bound of the exact value of an expression of at most 12 additions, multiplications and divisions of
// non-negative numbers, whose rounded value is `computed`.
inline double rounded_up(double computed) { return computed * (1 + 0x1p-49) + kUnderflow; }

struct Ball {
  double mid = 0, rad = 0;

  constexpr Ball() = default;
  constexpr Ball(double exactly) : mid(exactly) {}  // NOLINT(google-explicit-constructor): constants mix with balls
  constexpr Ball(double middle, double radius) : mid(middle), rad(radius) {}

  // Returns a ball that contains all reals between low and high.
  static Ball between(double low, double high) {
    const double middle = 0.5 * low + 0.5 * high;
    return {middle, rounded_up(std::max(high - middle, middle - low))};
  }
  static Ball unbounded() { return {0, std::numeric_limits<double>::infinity()}; }

  double magnitude() const { return rounded_up(std::abs(mid) + rad); }      // no element is larger
  double mignitude() const { return std::max(0.0, least(std::abs(mid))); }  // no element is smaller
  double upper() const { return -Ball(-mid, rad).lower(); }
  double lower() const { return least(mid); }
  // Returns whether every element of b is certainly in this ball.
  bool contains(const Ball& b) const { return rounded_up(std::abs(b.mid - mid) + b.rad) <= rad; }
  bool is_bounded() const { return std::abs(mid) < kLargest && rad < kLargest; }  // false for NaN

 private:
  double least(double middle) const {
    const double difference = middle - rad;
    return difference - 4 * kUnit * std::abs(difference) - kUnderflow;
  }
};

inline Ball operator-(const Ball& a) { return {-a.mid, a.rad}; }
inline Ball operator+(const Ball& a, const Ball& b) {
  const double m = a.mid + b.mid;
  return {m, rounded_up(a.rad + b.rad + kUnit * std::abs(m))};
}
inline Ball operator-(const Ball& a, const Ball& b) { return a + -b; }
inline Ball operator*(const Ball& a, const Ball& b) {
  const double m = a.mid * b.mid;
  return {m, rounded_up(std::abs(a.mid) * b.rad + a.rad * (std::abs(b.mid) + b.rad) + kUnit * std::abs(m))};
}
// a'/b' - a/b = ((a' - a) - (a/b) (b' - b)) / b'
inline Ball operator/(const Ball& a, const Ball& b) {
  const double least = b.mignitude();
  if (!(least > 0)) return Ball::unbounded();
  const double m = a.mid / b.mid;
  return {m, rounded_up((a.rad + std::abs(m) * b.rad * (1 + 4 * kUnit)) / least + kUnit * std::abs(m))};
}
inline Ball& operator+=(Ball& a, const Ball& b) { return a = a + b; }
inline Ball& operator-=(Ball& a, const Ball& b) { return a = a - b; }
inline Ball& operator*=(Ball& a, const Ball& b) { return a = a * b; }

// (m + e)^2 = m^2 + 2 m e + e^2 with e^2 in [0, r^2]. For a wide ball the result is half as wide as that of a product.
inline Ball square(const Ball& a) {
  const double half = 0.5 * a.rad * a.rad, m = a.mid * a.mid + half;
  return {m, rounded_up(2 * std::abs(a.mid) * a.rad + half + 4 * kUnit * std::abs(m))};
}

// |sin'|, |cos'| <= 1.
inline Ball sin(const Ball& a) {
  const double m = std::sin(a.mid);
  return {m, rounded_up(a.rad + kElementaryError * std::abs(m))};
}
inline Ball cos(const Ball& a) {
  const double m = std::cos(a.mid);
  return {m, rounded_up(a.rad + kElementaryError * std::abs(m))};
}
// exp(a + e) - exp(a) = exp(a) (exp(e) - 1), and exp(r) - 1 <= 2 r for r <= 1.
inline Ball exp(const Ball& a) {
  const double m = std::exp(a.mid);
  if (a.rad <= 1) return {m, rounded_up(m * (1 + kElementaryError) * 2 * a.rad + kElementaryError * m)};
  const double high = std::exp(a.upper()) * (1 + 2 * kElementaryError);
  return {high / 2, rounded_up(high / 2 * (1 + kElementaryError))};
}
// tanh increases, and where |tanh| >= t its slope is at most 1 - t^2.
inline Ball tanh(const Ball& a) {
  if (!a.is_bounded()) return Ball::unbounded();
  constexpr double kNarrow = 0.1;
  const double m = std::tanh(a.mid), error = kElementaryError * std::abs(m);
  if (a.rad < kNarrow) {
    const double least = std::max(0.0, std::abs(m) - a.rad - kElementaryError);
    const double slope = std::min(1.0, 1 - least * least + kElementaryError);
    return {m, rounded_up(a.rad * slope + error)};
  }
  const double low = std::max(-1.0, std::tanh(a.lower()) - kElementaryError),
               high = std::min(1.0, std::tanh(a.upper()) + kElementaryError);
  return Ball::between(low, high);
}

// 1 - tanh^2 = 4 e / (1 + e)^2 with e = exp(-2 |a|). This form has a small error also where tanh is near 1.
inline Ball sech2(const Ball& a) {
  if (!a.is_bounded()) return Ball::unbounded();
  const auto value = [](const Ball& size) {
    const Ball e = exp(-2.0 * size);
    return 4.0 * e / square(1.0 + e);
  };
  constexpr double kNarrow = 0.1;
  const Ball middle = value(Ball(std::abs(a.mid)));
  // |(sech^2)'| = 2 |tanh| sech^2, and sech^2 grows at most e^(2 r)-fold over a distance r.
  if (a.rad < kNarrow) return {middle.mid, rounded_up(middle.rad + middle.magnitude() * 3 * a.rad)};
  return Ball::between(std::max(0.0, value(Ball(a.magnitude())).lower()),
                       std::min(1.0, value(Ball(a.mignitude())).upper()));
}

// Sums of products, with the error of the whole sum instead of one after every term: n products summed in any order
// are off by at most (n + 1) kUnit of the sum of their magnitudes, to first order.
class SumOfProducts {
 public:
  void add(const Ball& a, const Ball& b, double weight = 1) {  // weight: a small integer
    const double p = weight * (a.mid * b.mid);
    mid_ += p;
    sizes_ += std::abs(p);
    rad_ += weight * (std::abs(a.mid) * b.rad + a.rad * (std::abs(b.mid) + b.rad));
    ++terms_;
  }
  // sign * the sum / divisor
  Ball total(double divisor = 1) const {
    const double m = mid_ / divisor;
    const double growth = 1 + (3 * terms_ + 8) * kUnit;  // of the sums of what is not negative
    return {m, rounded_up(growth * (rad_ + (terms_ + 4) * kUnit * sizes_) / divisor)};
  }

 private:
  double mid_ = 0, rad_ = 0, sizes_ = 0;
  int terms_ = 0;
};

// sum_k c[k] t^k by Horner's rule.
template <class Coefficients>
Ball polynomial(const Coefficients& c, std::size_t count, const Ball& t) {
  Ball value = c[count - 1];
  for (std::size_t k = count - 1; k-- > 0;) value = value * t + c[k];
  return value;
}

}  // namespace enclosure
