// L D L' of symmetric indefinite matrices whose graph is a chain of blocks with a border: the KKT matrices of
// collocation problems, where an interval sees itself, its neighbours and the durations.
//
// Multifrontal elimination (Duff & Reid, ACM TOMS 9, 1983) along the chain, from both ends to its middle, which two
// threads can do at a time: front k assembles block k and what the front before it left, eliminates every index that
// only these blocks see, and passes its Schur complement on, to front k + 1 or, in the second half, to k - 1. In a
// front
// - an index with a single neighbour, the slack of an inequality, goes first, together with that neighbour;
// - then the equality rows, whose own block is zero, together with as many variables that they determine: with A = (B
// N)
//   the rows' coefficients and H the symmetric matrix of the variables, the block (H_BB B'; B 0) has as many
//   eigenvalues of each sign as rows, whatever H is, and what it leaves is the matrix reduced to the other variables
//   (tableau.h);
// - the few that remain are pivots of a small dense matrix (dense_ldlt.h); what finds no good pivot is delayed to the
//   next front.
// Cost: O(blocks) times a small dense factorisation.
#pragma once

#include <array>
#include <atomic>
#include <limits>
#include <span>
#include <vector>

#include "common/parallel.h"
#include "planner/nlp/chain/dense_ldlt.h"
#include "planner/nlp/chain/tableau.h"

namespace fjr {

// What the rows of such a matrix are.
struct ChainStructure {
  int blocks = 0;
  std::vector<int> block;      // of every row, from 0; the border's have block `blocks`
  std::vector<bool> equality;  // per row: a row of the equality constraints; may be left empty
};

class ChainLdlt {
 public:
  // Pattern: entries (rows[e], cols[e]), 0-based, either triangle, repeated entries add up. Throws
  // std::invalid_argument if an entry joins two blocks that are neither neighbours nor one of them the border.
  void analyse(std::span<const int> rows, std::span<const int> cols, const ChainStructure& structure);

  enum class Outcome {
    kDone,             // the matrix may be solved with
    kTooManyNegative,  // it certainly has more negative eigenvalues than allowed, and was not factorised to the end
    kSingular,         // to working precision, or so nearly that pivots pile up
  };

  // Values of the entries. threshold in (0, 0.5]: a pivot must exceed this fraction of what it would divide; larger is
  // more stable and less sparse. most_negative: of the eigenvalues; equality rows must not have positive diagonals
  // where there is such a bound. both: does the two halves of the work, on threads as it likes; the numbers are the
  // same.
  Outcome factorise(std::span<const double> values, double threshold,
                    int most_negative = std::numeric_limits<int>::max(), const DoBoth& both = one_after_the_other);

  // Of the last factorised matrix: exact by Sylvester's law; at least so many where there are more than most_negative.
  int negative_eigenvalues() const { return negative_; }

  void solve(std::span<double> right_hand_side, const DoBoth& both = one_after_the_other) const;  // in place

  // Multiplications that the last factorisation took, and that one solve() with it takes: to a third or so, and the
  // same every time. Delayed pivots make them several times what the pattern alone would.
  double factorisation_work() const { return factorisation_work_; }
  double solve_work() const { return solve_work_; }

  int size() const { return size_; }

 private:
  struct Entry {
    int value, at, mirrored;  // which of the values, and where it goes: row x width of the front + column
  };
  struct LeafEntry {
    int value, column;
  };
  struct Leaf {  // an index with one neighbour
    int leaf, neighbour;
    // Where in leaf_entries_ those of (leaf, leaf), (leaf, neighbour), (neighbour, neighbour), and of the neighbour and
    // a column of the front begin.
    int own = 0, coupling = 0, diagonal = 0, others = 0, end = 0;
    // Numbers of the present factorisation:
    bool paired = false;                                    // both eliminated; otherwise the leaf alone
    double a_ll = 0, a_lp = 0, a_pp = 0;                    // the pivot block
    double inverse_ll = 0, inverse_lp = 0, inverse_pp = 0;  // of the 2 x 2 block when paired
  };
  struct Child {
    int front, first_column;  // where the columns that it passes on begin
  };
  struct Front {
    std::vector<Child> children;  // the fronts before it: two for the middle
    // Columns: indices that are no equality rows - those the fronts before it pass on, then what is this block's own,
    // what the next front sees too, and the border.
    std::vector<int> columns;
    int summed = 0, later = 0, width = 0;  // columns below `summed` become fully summed here; width is of all, padded
    std::vector<int> rows;                 // equality rows
    int rows_elsewhere = 0;                // equality rows that its branch has not come to by then
    std::vector<Entry> diagonal, symmetric, coupling, row_diagonal;  // of two columns, of a row and a column, of a row
    int first_leaf = 0, last_leaf = 0;                               // in leaves_
    // Numbers of the present factorisation:
    // Their numbers in the whole matrix: those of this front, rows that are treated as columns, those that the front
    // before it delayed, and columns that its leaves left.
    std::vector<int> column_index, row_index;
    Tableau tableau;
    std::vector<int> basic_rows;  // rows of the tableau that have a basic variable
    Rows curvature;               // per such row: the basic variable's row of the symmetric matrix
    DenseLdlt rest;  // rows: the columns that are not basic by their number, then tableau row r as columns + r
    int rest_summed = 0;
  };

  // Fronts that one thread eliminates one after the other.
  enum { kFromStart, kFromEnd, kMiddle };
  struct alignas(64) Branch {  // what two threads write is not in the same line of their caches
    std::vector<int> fronts;
    int rows = 0;  // equality rows of all of them
    // Of the present factorisation:
    int negative = 0;
    double factorisation_work = 0, solve_work = 0;
    // Work space:
    Rows symmetric;  // of the front being assembled, both triangles
    std::array<std::vector<int>, 2> rest_place;
    std::vector<int> row_place, basic, list;
    std::vector<double> row_diagonal;
    Rows weights, u, z, x;
    mutable Rows vectors;
    mutable std::vector<double> rest_values;
  };

  void set_branches(const std::vector<std::vector<int>>& shared, const std::vector<std::vector<int>>& own);
  int prepare_leaves(std::span<const double> values);
  Outcome eliminate(Branch& branch, std::span<const double> values, double threshold, int most_negative,
                    const std::atomic<bool>& of_no_use);
  void assemble(Front& front, std::span<const double> values, Branch& work) const;
  static bool reduce(Front& front, bool last, Branch& work);
  static void count_work(const Front& front, Branch& work);
  static double& column_value(const Front& front, std::span<double> b, int j);
  static double& row_value(const Front& front, std::span<double> b, int r);
  void solve_forward(const Branch& branch, std::span<double> b) const;
  void solve_backward(const Branch& branch, std::span<double> b) const;
  static void solve_forward(const Front& front, std::span<double> b, Rows& vectors);
  static void solve_backward(const Front& front, std::span<double> b, Rows& vectors);

  int size_ = 0;
  int negative_ = 0, negative_of_leaves_ = 0;
  double factorisation_work_ = 0, solve_work_ = 0;
  std::vector<int> border_;
  std::vector<Front> fronts_;
  std::array<Branch, 3> branches_;
  std::vector<Leaf> leaves_;  // by front
  std::vector<LeafEntry> leaf_entries_;
  std::vector<double> leaf_values_;     // of leaf_entries_
  mutable std::vector<double> values_;  // of all indices, then of the border as the branch from the end knows it
};

}  // namespace fjr
