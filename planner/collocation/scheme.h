// Collocation schemes as tables of coefficients. A new scheme is a function with its list of points, plus its entry in
// all_schemes().
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace fjr {

// A collocation method with s points c on [0, 1] is the implicit Runge-Kutta method
//   y_i = y_0 + h sum_j A(i,j) f(y_j, u_j),   int L dt = h sum_j b(j) L(y_j, u_j),
// with A(i,j) = int_0^c_i l_j and b(j) = int_0^1 l_j, l_j the Lagrange basis of c.
// Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, theorem II.7.7; Betts, ch. 4.
// The last point is 1 for every scheme here: the end of an interval is its last stage.
struct Scheme {
  std::string name;
  int order = 0;                // order of convergence of the state at the nodes on smooth problems
  Eigen::VectorXd points;       // c, increasing, last 1
  Eigen::MatrixXd A;            // s x s
  Eigen::VectorXd b;            // s
  bool starts_at_node = false;  // c_0 = 0: the first stage is the interval's start itself (Lobatto IIIA)
  // s x 2; collocation point j has the control (1 - c_j) u_begin + c_j u_end. Controls are linear on an interval, as
  // the published torque is between its samples, and may jump at nodes. A polynomial of higher degree would overshoot
  // the limits between the points where a torque switches, and published samples cannot represent that.
  Eigen::MatrixXd control_fraction;

  int stages() const { return static_cast<int>(points.size()); }
  // The Lagrange basis l_j in monomials of c: s x s, row j holds the coefficients of l_j, lowest degree first.
  Eigen::MatrixXd lagrange;
};

// Computes the tables for increasing points in [0, 1], the last of which is 1.
Scheme collocation(std::string name, int order, const std::vector<double>& points);

Scheme trapezoidal();      // Lobatto IIIA, 2 points, order 2
Scheme hermite_simpson();  // Lobatto IIIA, 3 points, order 4
Scheme lobatto4();         // Lobatto IIIA, 4 points, order 6
Scheme radau3();           // Radau IIA, 3 points, order 5

std::vector<Scheme> all_schemes();
// Returns their names as the documentation lists them: `trapezoidal`, `hermite-simpson`, ...
const std::string& names_of_schemes();
// Throws std::invalid_argument listing the known names.
Scheme find_scheme(std::string_view name);

}  // namespace fjr
