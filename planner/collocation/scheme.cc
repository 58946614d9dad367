#include "planner/collocation/scheme.h"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

namespace fjr {
namespace {

// Monomial coefficients of the Lagrange basis polynomials of `points`, one per row, lowest degree first.
Eigen::MatrixXd lagrange_coefficients(const Eigen::VectorXd& points) {
  const Eigen::Index s = points.size();
  Eigen::MatrixXd vandermonde(s, s);
  for (Eigen::Index i = 0; i < s; ++i) {
    for (Eigen::Index k = 0; k < s; ++k) vandermonde(i, k) = std::pow(points(i), static_cast<double>(k));
  }
  return vandermonde.inverse().transpose();
}

// Returns the integral from 0 to c of every polynomial, one per row of `coefficients`.
Eigen::VectorXd integrals(const Eigen::MatrixXd& coefficients, double c) {
  Eigen::VectorXd powers(coefficients.cols());
  for (Eigen::Index k = 0; k < powers.size(); ++k) {
    powers(k) = std::pow(c, static_cast<double>(k + 1)) / static_cast<double>(k + 1);
  }
  return coefficients * powers;
}

}  // namespace

Scheme collocation(std::string name, int order, const std::vector<double>& points) {
  Scheme s;
  s.name = std::move(name);
  s.order = order;
  s.points = Eigen::Map<const Eigen::VectorXd>(points.data(), static_cast<Eigen::Index>(points.size()));
  s.lagrange = lagrange_coefficients(s.points);
  s.A.resize(s.points.size(), s.points.size());
  for (Eigen::Index i = 0; i < s.points.size(); ++i) s.A.row(i) = integrals(s.lagrange, s.points(i)).transpose();
  s.b = integrals(s.lagrange, 1);
  s.starts_at_node = points.front() == 0;
  s.control_fraction.resize(s.points.size(), 2);
  s.control_fraction << Eigen::VectorXd::Ones(s.points.size()) - s.points, s.points;
  return s;
}

Scheme trapezoidal() { return collocation("trapezoidal", 2, {0, 1}); }
Scheme hermite_simpson() { return collocation("hermite-simpson", 4, {0, 0.5, 1}); }
Scheme lobatto4() { return collocation("lobatto4", 6, {0, 0.5 - std::sqrt(0.05), 0.5 + std::sqrt(0.05), 1}); }
Scheme radau3() { return collocation("radau3", 5, {(4 - std::sqrt(6.0)) / 10, (4 + std::sqrt(6.0)) / 10, 1}); }

std::vector<Scheme> all_schemes() { return {trapezoidal(), hermite_simpson(), lobatto4(), radau3()}; }

const std::string& names_of_schemes() {
  static const std::string names = [] {
    std::string text;
    for (const Scheme& s : all_schemes()) text += (text.empty() ? "`" : ", `") + s.name + "`";
    return text;
  }();
  return names;
}

Scheme find_scheme(std::string_view name) {
  std::string known;
  for (Scheme& s : all_schemes()) {
    if (s.name == name) return s;
    known += (known.empty() ? "" : ", ") + s.name;
  }
  throw std::invalid_argument("no collocation scheme '" + std::string(name) + "'; there are " + known);
}

}  // namespace fjr
