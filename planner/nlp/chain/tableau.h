// The equality rows of one block, solved for as many of the variables they see as find a good pivot, in place
// (Gauss-Jordan: the exchange of a row's right-hand side with a variable). Afterwards a row with basic variable c says
//   x_c = sum over basic columns j of a(row, j) b(row of j) - sum over the other columns j of a(row, j) x_j,
// and a row without one, which saw too little of the candidates,
//   sum over the other columns j of a(row, j) x_j = b(row) + sum over basic columns j of a(row, j) b(row of j).
#pragma once

#include <span>
#include <vector>

#include "planner/nlp/chain/rows.h"

namespace fjr {

class Tableau {
 public:
  void reset(int rows, int columns);  // to zero

  int rows() const { return static_cast<int>(basic_.size()); }
  int columns() const { return static_cast<int>(row_of_.size()); }
  int width() const { return a_.width(); }
  double* row(int i) { return a_.row(i); }
  const double* row(int i) const { return a_.row(i); }
  double* data() { return a_.data(); }
  const double* data() const { return a_.data(); }

  // preference: per column (a padded row), 0 for what may not become basic, otherwise the larger the sooner. bounding:
  // 1 for the columns whose growth counts, 0 for others. Both are used up. False when a row depends on others:
  // elimination left nothing of it but rounding.
  bool solve_for_basis(double* preference, double* bounding);

  int basic(int i) const { return basic_[static_cast<std::size_t>(i)]; }    // column of row i, -1 without
  int row_of(int j) const { return row_of_[static_cast<std::size_t>(j)]; }  // row of column j, -1 if not basic

 private:
  Rows a_;
  std::vector<int> basic_, row_of_;
  std::vector<double> size_;  // per row: largest magnitude before elimination
};

}  // namespace fjr
