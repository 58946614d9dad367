// Factorises symmetric indefinite matrices as L D L' whose graph is a chain of blocks with a border. The KKT matrices
// of collocation problems have this form: an interval is coupled to its neighbours and to the durations (the border).
//
// Multifrontal elimination (Duff & Reid, ACM TOMS 9, 1983) along the chain, from both ends to its middle, which two
// threads can do concurrently: front k assembles block k and the Schur complement of the front before it, eliminates
// every index that is coupled to no later block, and passes its own Schur complement on to front k + 1 or, in the
// second half, to k - 1. In a front
// - an index with a single neighbour (a leaf: the slack of an inequality) is eliminated first, together with that
//   neighbour;
// - then the equality rows, whose own block is zero, are eliminated together with as many variables that they
//   determine. Let A = (B N) be the coefficients of the rows and H the symmetric matrix of the variables. The block
//   (H_BB B'; B 0) has as many positive and as many negative eigenvalues as there are rows, whatever H is, and its
//   Schur complement is the matrix reduced to the other variables (tableau.h);
// - the few indices that remain are pivots of a small dense matrix (dense_ldlt.h). One that finds no good pivot is
//   delayed to the next front.
// The cost is that of a small dense factorisation per block.
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

// Tells the block of each row of such a matrix, and which rows are equality constraints.
struct ChainStructure {
  int blocks = 0;
  std::vector<int> block;      // per row, from 0; the rows of the border have block `blocks`
  std::vector<bool> equality;  // per row: whether it is an equality constraint; may be left empty
};

class ChainLdlt {
 public:
  // Sets the sparsity pattern: entries (rows[e], cols[e]), 0-based, in either triangle; repeated entries add up. Throws
  // std::invalid_argument if an entry couples two blocks that are not neighbours, unless one of them is the border.
  void analyse(std::span<const int> rows, std::span<const int> cols, const ChainStructure& structure);

  enum class Outcome {
    kDone,             // the matrix may be solved with
    kTooManyNegative,  // it certainly has more negative eigenvalues than allowed, and was not factorised to the end
    kSingular,         // to working precision, or so nearly that too many pivots are delayed
  };

  // Factorises the matrix with these values of the entries. threshold in (0, 0.5]: a pivot must exceed this fraction of
  // the entries it divides; a larger one is more stable and gives more fill-in. most_negative: as soon as the matrix is
  // known to have more negative eigenvalues than this, the factorisation ends and solve() must not be called. With a
  // finite most_negative, equality rows must not have positive diagonal entries. both: runs the two halves of the work,
  // possibly on two threads; the results are the same bits.
  Outcome factorise(std::span<const double> values, double threshold,
                    int most_negative = std::numeric_limits<int>::max(), const DoBoth& both = one_after_the_other);

  // Returns the number of negative eigenvalues of the last matrix. It is exact by Sylvester's law of inertia, and a
  // lower bound if it exceeds most_negative.
  int negative_eigenvalues() const { return negative_; }

  // Replaces the right-hand side, one number for each row of the matrix, by the solution. Only after a factorise() that
  // returned kDone.
  void solve(std::span<double> right_hand_side, const DoBoth& both = one_after_the_other) const;

  // Return the number of multiplications of the last factorisation, and of one solve() with it. They are accurate to
  // about a third and reproducible. Delayed pivots can make them several times larger than the pattern suggests.
  double factorisation_work() const { return factorisation_work_; }
  double solve_work() const { return solve_work_; }

 private:
  struct Entry {
    int value, at, mirrored;  // index of the value, and its positions in the front: row * width + column
  };
  struct LeafEntry {
    int value, column;
  };
  struct Leaf {  // an index with one neighbour
    int leaf, neighbour;
    // First index in leaf_entries_ of the entries (leaf, leaf), (leaf, neighbour), (neighbour, neighbour), and of those
    // between the neighbour and columns of the front; then the end of the latter.
    int own = 0, coupling = 0, diagonal = 0, others = 0, end = 0;
    // Set by the current factorisation:
    bool paired = false;                                    // both eliminated; otherwise the leaf alone
    double a_ll = 0, a_lp = 0, a_pp = 0;                    // the pivot block
    double inverse_ll = 0, inverse_lp = 0, inverse_pp = 0;  // of the 2 x 2 block when paired
  };
  struct Child {
    int front, first_column;  // position of the first column that it passes on
  };
  struct Front {
    std::vector<Child> children;  // the fronts whose Schur complements it receives; the middle has two
    // Columns are the indices that are not equality rows, in this order: those passed on by the children, those of this
    // block alone, those that are coupled to the next front, and the border.
    std::vector<int> columns;
    // The first `summed` columns are fully summed here, the next `later` go to the next front. width: of all, padded.
    int summed = 0, later = 0, width = 0;
    std::vector<int> rows;   // equality rows
    int rows_elsewhere = 0;  // number of equality rows of all other fronts but those before it in its branch
    std::vector<Entry> diagonal, symmetric, coupling, row_diagonal;  // of two columns, of a row and a column, of a row
    int first_leaf = 0, last_leaf = 0;                               // in leaves_
    // Set by the current factorisation. Index in the whole matrix of each column and row of the front, including rows
    // that are treated as columns, pivots delayed by the children, and neighbours of leaves that were eliminated alone.
    std::vector<int> column_index, row_index;
    Tableau tableau;
    std::vector<int> basic_rows;  // rows of the tableau that have a basic variable
    Rows curvature;               // per such row: the row of H that belongs to the basic variable
    DenseLdlt rest;  // its index(): the number of a column that is not basic, or columns + r for tableau row r
    int rest_summed = 0;

    int new_column(int i) {
      column_index.push_back(i);
      return static_cast<int>(column_index.size()) - 1;
    }
    int new_row(int i) {
      row_index.push_back(i);
      return static_cast<int>(row_index.size()) - 1;
    }
  };

  // A branch is a sequence of fronts that one thread eliminates.
  enum { kFromStart, kFromEnd, kMiddle };
  struct alignas(64) Branch {  // aligned so that two threads do not write to the same cache line
    std::vector<int> fronts;
    int rows = 0;  // number of equality rows of all its fronts
    // Set by the current factorisation:
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

  struct Pattern;

  std::vector<int> find_leaves(const Pattern& of);
  void set_fronts(const Pattern& of, const std::vector<int>& leaf_role);
  void set_branches(const std::vector<std::vector<int>>& shared, const std::vector<std::vector<int>>& own);
  static std::vector<int> owners(const Pattern& of, const std::vector<int>& leaf_role);
  static void set_entries(const Pattern& of, std::span<const int> entries, const std::vector<int>& place, Front& front);
  void set_leaf_entries(const Pattern& of, std::span<const int> entries, const std::vector<int>& place, Leaf& leaf);

  int prepare_leaves(std::span<const double> values);
  Outcome eliminate(Branch& branch, std::span<const double> values, double threshold, int most_negative,
                    const std::atomic<bool>& of_no_use);
  void assemble(Front& front, std::span<const double> values, Branch& work) const;
  int lay_out(Front& front, std::span<const double> values, Branch& work) const;
  void place_rest(const Child& child, Front& front, std::vector<int>& rest_place) const;
  static void add_entries(Front& front, std::span<const double> values, Branch& work);
  void add_leaves(const Front& front, int first_leaf_column, Branch& work) const;
  void add_rests(Front& front, Branch& work) const;
  static bool reduce(Front& front, bool last, Branch& work);
  static void list_columns(Front& front, bool last, Branch& work);
  static void copy_basic_rows(Front& front, Branch& work);
  static void set_rest(Front& front, Branch& work);
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
  mutable std::vector<double> values_;  // per index; then the contributions to the border of the branch from the end
};

}  // namespace fjr
