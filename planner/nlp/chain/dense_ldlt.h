// Factorises a small dense symmetric indefinite matrix as L D L', as far as stable pivots are found.
//
// Pivots are 1 x 1 and 2 x 2 as in Bunch & Kaufman's method, and are accepted only if they bound the growth of the
// entries of the whole matrix.
#pragma once

#include <span>
#include <vector>

#include "planner/nlp/chain/rows.h"

namespace fjr {

class DenseLdlt {
 public:
  // Starts a matrix with one row per element of `index`, which the caller chooses to identify the rows. The caller then
  // sets all entries of both triangles.
  void reset(std::span<const int> index);

  int order() const { return static_cast<int>(index_.size()); }
  int pivots() const { return pivots_; }
  const std::vector<int>& index() const { return index_; }  // per row, in the order of elimination
  double* row(int i) { return matrix_.row(i); }
  const double* row(int i) const { return matrix_.row(i); }

  // Eliminates as many of the first `candidates` rows as find a stable pivot. Afterwards the rows and columns from
  // pivots() on hold the Schur complement. threshold in (0, 0.5]: a pivot must exceed this fraction of the entries it
  // divides. Returns the number of negative eigenvalues of the eliminated part.
  int eliminate(int candidates, double threshold);

  // x: one number per row, in the order of index().
  void solve_forward(std::span<double> x) const;   // L x = b
  void solve_backward(std::span<double> x) const;  // D L' x = b; x of the rows that were not eliminated is given

 private:
  void judge_as_is(int first);
  void judge_scaled(int first);
  void exchange(int p, int q);
  double largest(int i, int c, int d);
  double scaled(int i, int j) const;
  bool is_stable(int c, double wanted);
  bool is_stable(int c, int r, double wanted);
  int partner_of(int c, int first, int candidates) const;
  int eliminate_one(int p, int c);
  int eliminate_two(int p, int c, int r);

  std::vector<int> index_;
  Rows matrix_;                // the first `pivots_` rows hold L' right of the diagonal
  Rows weights_;               // one row: scale factors of rows and columns for the pivot tests, 0 where eliminated
  std::vector<double> d_, e_;  // D: diagonal, and subdiagonal where a 2 x 2 block begins (else 0)
  int pivots_ = 0;
};

}  // namespace fjr
