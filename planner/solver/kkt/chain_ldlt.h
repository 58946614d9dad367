// L D L' of symmetric indefinite matrices whose graph is a chain of stages with a border: the KKT matrices of
// collocation problems, where an interval sees itself, its neighbours and the durations.
//
// Multifrontal elimination (Duff & Reid, ACM TOMS 9, 1983) along the chain: front k assembles stage k and what front
// k - 1 left, eliminates every index that no later stage sees, and passes its Schur complement on. Pivots are 1 x 1 and
// 2 x 2 after Bunch & Kaufman, accepted only if they bound the growth of the whole front; what finds no good pivot is
// delayed to the next front. An index with a single neighbour - the slack of an inequality - and that neighbour are
// eliminated before any front. Cost: O(stages) times a small dense factorisation.
#pragma once

#include <span>
#include <vector>

namespace fjr {

class ChainLdlt {
 public:
  // Pattern: entries (rows[e], cols[e]), 0-based, either triangle, repeated entries add up. stage[i] is the stage of
  // index i, from 0; the border's indices have stage `stages`. Throws std::invalid_argument if an entry joins two
  // stages that are neither neighbours nor one of them the border.
  void analyse(int size, std::span<const int> rows, std::span<const int> cols, std::span<const int> stage, int stages);

  // Values of the entries. False when the matrix is singular to working precision, or so nearly that pivots pile up.
  // threshold in (0, 0.5]: a pivot must exceed this share of what it would divide; larger is more stable and less
  // sparse.
  bool factorise(std::span<const double> values, double threshold);

  int negative_eigenvalues() const { return negative_; }  // of the last factorised matrix, exact by Sylvester's law

  void solve(std::span<double> right_hand_side) const;  // in place

  int size() const { return size_; }

 private:
  struct Entry {
    int value, row, col;
  };
  struct Leaf {  // an index with one neighbour
    int leaf, neighbour, front;
    std::vector<Entry> own;       // (leaf, leaf)
    std::vector<Entry> coupling;  // (leaf, neighbour)
    std::vector<Entry> diagonal;  // (neighbour, neighbour)
    std::vector<Entry> others;    // (neighbour, x): col is x
    // Numbers of the present factorisation:
    bool paired = false;                                    // both eliminated; otherwise the leaf alone
    double a_ll = 0, a_lp = 0, a_pp = 0;                    // the pivot block
    double inverse_ll = 0, inverse_lp = 0, inverse_pp = 0;  // of the 2 x 2 block when paired
    std::vector<double> weights;                            // values of `others`
  };
  struct Front {
    std::vector<int> own;        // indices that become fully summed here, leaves and their neighbours apart
    std::vector<int> later;      // indices of this stage that the next one sees too
    std::vector<Entry> entries;  // assembled here
    std::vector<int> leaves;     // into leaves_
    // Numbers of the present factorisation:
    std::vector<int> index;      // global index per local row, pivots first
    std::vector<double> matrix;  // order x order, column major, lower triangle: unit L in the first `pivots` columns
    std::vector<double> d, e;    // D: diagonal, and subdiagonal where a 2 x 2 block begins (else 0)
    int order = 0, pivots = 0;
  };

  void prepare_leaves(std::span<const double> values);
  void assemble(std::size_t k, std::span<const double> values);
  int eliminate(Front& front, int fully_summed, double threshold);

  int size_ = 0;
  int negative_ = 0;
  std::vector<int> border_;
  std::vector<Front> fronts_;
  std::vector<Leaf> leaves_;
  std::vector<int> leaf_role_;  // per index: -1 none, else the Leaf it is part of
  std::vector<int> local_;      // per index: row in the front being assembled, -1 elsewhere
  mutable std::vector<double> work_;
};

}  // namespace fjr
