// L D L' of a small dense symmetric indefinite matrix, as far as its pivots are good.
//
// Pivots are 1 x 1 and 2 x 2 after Bunch & Kaufman, accepted only if they bound the growth of the whole matrix.
#pragma once

#include <span>
#include <vector>

#include "planner/nlp/chain/rows.h"

namespace fjr {

class DenseLdlt {
 public:
  // Rows are known by what `index` says of them. The entries are then to be set, all of them and both triangles.
  void reset(std::span<const int> index);

  int order() const { return static_cast<int>(index_.size()); }
  int pivots() const { return pivots_; }
  const std::vector<int>& index() const { return index_; }  // per row, in the order of elimination
  double* row(int i) { return matrix_.row(i); }
  const double* row(int i) const { return matrix_.row(i); }

  // Eliminates as many of the first `candidates` rows as find a good pivot; what is left of the others' block, rows and
  // columns from pivots() on, is their Schur complement. threshold in (0, 0.5]: a pivot must exceed this fraction of
  // what it would divide. Returns the number of negative eigenvalues of what was eliminated.
  int eliminate(int candidates, double threshold);

  // x: one number per row, in the order of index().
  void solve_forward(std::span<double> x) const;   // L x = b
  void solve_backward(std::span<double> x) const;  // D L' x = b, the rows that were not eliminated given

 private:
  void judge_as_is(int first);
  void judge_scaled(int first);
  void exchange(int p, int q);
  double largest(int i, int c, int d);

  std::vector<int> index_;
  Rows matrix_;                // of the first `pivots_` rows, right of the diagonal: L'
  Rows weights_;               // one row: what rows and columns are scaled by to judge pivots, 0 where eliminated
  std::vector<double> d_, e_;  // D: diagonal, and subdiagonal where a 2 x 2 block begins (else 0)
  int pivots_ = 0;
};

}  // namespace fjr
