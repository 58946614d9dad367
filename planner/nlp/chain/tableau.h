// The equality rows of one block, A x = b. They are solved in place for as many variables as have a stable pivot
// (Gauss-Jordan elimination; each step exchanges the right-hand side of a row with a variable, which becomes basic).
// Afterwards a row with basic variable c means
//   x_c = sum over basic columns j of a(row, j) b(row of j) - sum over the other columns j of a(row, j) x_j,
// and a row without one, whose entries in the candidate columns were too small,
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

  // preference: per column (a padded row), 0 if it must not become basic, otherwise larger ones are chosen first.
  // bounding: 1 for the columns that the pivot is compared with, 0 for others. Both arrays are overwritten. Returns
  // false if a row is linearly dependent on others, that is, elimination leaves only rounding errors of it.
  bool solve_for_basis(double* preference, double* bounding);

  int basic(int i) const { return basic_[static_cast<std::size_t>(i)]; }    // basic column of row i, -1 if none
  int row_of(int j) const { return row_of_[static_cast<std::size_t>(j)]; }  // row of column j, -1 if not basic

 private:
  Rows a_;
  std::vector<int> basic_, row_of_;
  std::vector<double> size_;  // per row: largest magnitude before elimination
};

}  // namespace fjr
