#include "planner/nlp/chain/chain_ldlt.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>

#include "planner/nlp/chain/products.h"
#include "planner/nlp/chain/vectorised.h"

namespace fjr {
namespace {

constexpr int kMostDelayed = 40;

// A slack whose own curvature exceeds this is eliminated alone. Eliminating it together with its constraint would add
// the large number to the block of the states, where smaller entries would lose their digits by cancellation.
constexpr double kLargestCondensed = 1e4;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

// A dense matrix of which both triangles are stored.
struct SymmetricMatrix {
  double* data;
  int width;

  void add(int i, int j, double value) const {
    data[i * width + j] += value;
    if (i != j) data[j * width + i] += value;
  }
};

}  // namespace

// Computes the pivots of the leaves and returns the number of their negative eigenvalues.
int ChainLdlt::prepare_leaves(std::span<const double> values) {
  int negative = 0;
  for (std::size_t e = 0; e < leaf_entries_.size(); ++e) leaf_values_[e] = values[index(leaf_entries_[e].value)];
  const auto sum = [this](int begin, int end) {
    double total = 0;
    for (int e = begin; e < end; ++e) total += leaf_values_[index(e)];
    return total;
  };
  for (Leaf& leaf : leaves_) {
    leaf.a_ll = sum(leaf.own, leaf.coupling);
    leaf.a_lp = sum(leaf.coupling, leaf.diagonal);
    leaf.a_pp = sum(leaf.diagonal, leaf.others);
    const double determinant = leaf.a_ll * leaf.a_pp - leaf.a_lp * leaf.a_lp;
    leaf.paired = std::abs(leaf.a_ll) <= kLargestCondensed * leaf.a_lp * leaf.a_lp && determinant < 0;
    if (leaf.paired) {
      leaf.inverse_ll = leaf.a_pp / determinant;
      leaf.inverse_lp = -leaf.a_lp / determinant;
      leaf.inverse_pp = leaf.a_ll / determinant;
      ++negative;  // determinant < 0: one eigenvalue of each sign
    } else if (leaf.a_ll < 0) {
      ++negative;
    }
  }
  return negative;
}

// Determines which indices the columns and rows of a front are: those of the pattern, and what the present numbers add.
// Returns the first column of the neighbours of leaves that are eliminated alone.
int ChainLdlt::lay_out(Front& front, std::span<const double> values, Branch& work) const {
  front.column_index = front.columns;
  front.row_index.clear();
  // A row with an entry on the diagonal is treated as a column, ~column in row_place.
  work.row_diagonal.assign(front.rows.size(), 0);
  for (const Entry& e : front.row_diagonal) work.row_diagonal[index(e.at / front.width)] += values[index(e.value)];
  work.row_place.clear();
  for (std::size_t r = 0; r < front.rows.size(); ++r) {
    work.row_place.push_back(work.row_diagonal[r] == 0 ? front.new_row(front.rows[r])
                                                       : ~front.new_column(front.rows[r]));
  }
  for (std::size_t c = 0; c < front.children.size(); ++c) place_rest(front.children[c], front, work.rest_place[c]);
  const int first_leaf_column = static_cast<int>(front.column_index.size());
  for (int l = front.first_leaf; l < front.last_leaf; ++l) {
    if (!leaves_[index(l)].paired) front.new_column(leaves_[index(l)].neighbour);
  }
  const int columns = static_cast<int>(front.column_index.size());
  front.tableau.reset(static_cast<int>(front.row_index.size()), columns);
  work.symmetric.resize_to_zero(columns, columns);
  return first_leaf_column;
}

// Places what a child front has not eliminated: ~row for a row of this front, otherwise a column. Delayed rows that
// have no entries among themselves stay rows, all other delayed pivots become columns.
void ChainLdlt::place_rest(const Child& child, Front& front, std::vector<int>& rest_place) const {
  const Front& previous = fronts_[index(child.front)];
  const DenseLdlt& rest = previous.rest;
  const int columns = static_cast<int>(previous.column_index.size());
  rest_place.clear();
  const auto is_row = [&](int p) {
    if (rest.index()[index(p)] < columns || rest.row(p)[p] != 0) return false;
    for (int q = rest.pivots(); q < p; ++q) {
      if (rest_place[index(q - rest.pivots())] < 0 && rest.row(p)[q] != 0) return false;
    }
    return true;
  };
  for (int p = rest.pivots(); p < rest.order(); ++p) {
    const int local = rest.index()[index(p)];
    if (p < previous.rest_summed) {
      const int global =
          local < columns ? previous.column_index[index(local)] : previous.row_index[index(local - columns)];
      rest_place.push_back(is_row(p) ? ~front.new_row(global) : front.new_column(global));
    } else if (local < previous.summed + previous.later) {
      rest_place.push_back(local - previous.summed + child.first_column);
    } else {
      rest_place.push_back(local - previous.summed - previous.later + front.summed + front.later);
    }
  }
}

// Adds the entries of the front's block.
void ChainLdlt::add_entries(Front& front, std::span<const double> values, Branch& work) {
  const SymmetricMatrix s{work.symmetric.data(), front.tableau.width()};
  const bool all_rows =
      std::all_of(work.row_diagonal.begin(), work.row_diagonal.end(), [](double d) { return d == 0; });
  if (s.width == front.width && all_rows) {  // nothing was delayed, so the positions from analyse() are valid
    double* t = front.tableau.data();
    for (const Entry& e : front.diagonal) s.data[e.at] += values[index(e.value)];
    for (const Entry& e : front.symmetric) {
      s.data[e.at] += values[index(e.value)];
      s.data[e.mirrored] += values[index(e.value)];
    }
    for (const Entry& e : front.coupling) t[e.at] += values[index(e.value)];
    return;
  }
  const auto row = [&front](const Entry& e) { return e.at / front.width; };
  const auto column = [&front](const Entry& e) { return e.at % front.width; };
  for (const Entry& e : front.diagonal) s.add(row(e), column(e), values[index(e.value)]);
  for (const Entry& e : front.symmetric) s.add(row(e), column(e), values[index(e.value)]);
  for (const Entry& e : front.coupling) {
    const int place = work.row_place[index(row(e))];
    if (place >= 0) {
      front.tableau.row(place)[column(e)] += values[index(e.value)];
    } else {
      s.add(~place, column(e), values[index(e.value)]);
    }
  }
  for (std::size_t r = 0; r < front.rows.size(); ++r) {
    if (work.row_place[r] < 0) s.add(~work.row_place[r], ~work.row_place[r], work.row_diagonal[r]);
  }
}

// Adds the Schur complements of the leaves of the front's block.
void ChainLdlt::add_leaves(const Front& front, int first_leaf_column, Branch& work) const {
  const SymmetricMatrix s{work.symmetric.data(), front.tableau.width()};
  int leaf_column = first_leaf_column;
  for (int l = front.first_leaf; l < front.last_leaf; ++l) {
    const Leaf& leaf = leaves_[index(l)];
    if (leaf.paired) {
      for (int e = leaf.others; e < leaf.end; ++e) {
        const double factor = -leaf.inverse_pp * leaf_values_[index(e)];
        double* row = s.data + leaf_entries_[index(e)].column * s.width;
        for (int f = leaf.others; f < leaf.end; ++f)
          row[leaf_entries_[index(f)].column] += factor * leaf_values_[index(f)];
      }
    } else {
      s.add(leaf_column, leaf_column, leaf.a_pp - leaf.a_lp * leaf.a_lp / leaf.a_ll);
      for (int e = leaf.others; e < leaf.end; ++e)
        s.add(leaf_column, leaf_entries_[index(e)].column, leaf_values_[index(e)]);
      ++leaf_column;
    }
  }
}

// Adds the Schur complements of the child fronts.
void ChainLdlt::add_rests(Front& front, Branch& work) const {
  const SymmetricMatrix s{work.symmetric.data(), front.tableau.width()};
  for (std::size_t c = 0; c < front.children.size(); ++c) {
    const DenseLdlt& rest = fronts_[index(front.children[c].front)].rest;
    const std::vector<int>& rest_place = work.rest_place[c];
    for (int q = rest.pivots(); q < rest.order(); ++q) {
      const int j = rest_place[index(q - rest.pivots())];
      for (int p = q; p < rest.order(); ++p) {
        const int i = rest_place[index(p - rest.pivots())];
        if (i >= 0 && j >= 0) {
          s.add(i, j, rest.row(q)[p]);
        } else if (i >= 0 || j >= 0) {
          front.tableau.row(~std::min(i, j))[std::max(i, j)] += rest.row(q)[p];
        }
      }
    }
  }
}

// Assembles a front: the entries of its block plus the Schur complements of its leaves and of its child fronts.
void ChainLdlt::assemble(Front& front, std::span<const double> values, Branch& work) const {
  const int first_leaf_column = lay_out(front, values, work);
  add_entries(front, values, work);
  add_leaves(front, first_leaf_column, work);
  add_rests(front, work);
}

// Eliminates the equality rows together with their basic variables, and sets up the dense matrix of what is left
// (front.rest). Returns false if a row is linearly dependent on others.
bool ChainLdlt::reduce(Front& front, bool last, Branch& work) {
  Tableau& tableau = front.tableau;
  const int columns = tableau.columns(), width = tableau.width(), fixed = static_cast<int>(front.columns.size());
  const double* s = work.symmetric.data();
  const auto may_go = [&](int j) { return last || j < front.summed || j >= fixed; };

  work.weights.resize_to_zero(2, columns);
  double *preference = work.weights.row(0), *bounding = work.weights.row(1);
  for (int j = 0; j < columns; ++j) {
    const double own = std::abs(s[j * width + j]);
    if (may_go(j)) preference[j] = own <= kLargestCondensed ? 1 : std::sqrt(kLargestCondensed / own);
    if (may_go(j) || j < front.summed + front.later) bounding[j] = 1;
  }
  if (!tableau.solve_for_basis(preference, bounding)) return false;

  list_columns(front, last, work);
  work.negative += static_cast<int>(work.basic.size());
  copy_basic_rows(front, work);
  // The reduced Hessian H_NN - H_NB Z - Z' H_BN + Z' H_BB Z is H_NN - X - X' with X = (H_BN - H_BB Z / 2)' Z.
  const int count = static_cast<int>(work.list.size()), basics = static_cast<int>(work.basic.size());
  const int others = work.x.width();
  add_product(-0.5, front.curvature.data(), width, work.basic, work.z.data(), others, work.u.data());
  transposed_product(work.u.data(), count, work.z.data(), basics, others, work.x.data());
  set_rest(front, work);
  return true;
}

// Lists the basic columns and, in this order, what is left: fully summed columns, rows without a basic variable, and
// the other columns.
void ChainLdlt::list_columns(Front& front, bool last, Branch& work) {
  const Tableau& tableau = front.tableau;
  const int columns = tableau.columns(), fixed = static_cast<int>(front.columns.size());
  work.basic.clear();
  work.list.clear();
  front.basic_rows.clear();
  for (int j = 0; j < columns; ++j) {
    if (j == front.summed) j = fixed;
    if (j < columns && tableau.row_of(j) < 0) work.list.push_back(j);
  }
  for (int r = 0; r < tableau.rows(); ++r) {
    if (tableau.basic(r) < 0) {
      work.list.push_back(columns + r);
    } else {
      front.basic_rows.push_back(r);
      work.basic.push_back(tableau.basic(r));
    }
  }
  const int leaving = static_cast<int>(work.list.size());
  for (int j = front.summed; j < fixed; ++j) {
    if (tableau.row_of(j) < 0) work.list.push_back(j);
  }
  front.rest_summed = last ? static_cast<int>(work.list.size()) : leaving;
}

// Copies the rows of H that belong to basic variables (H_BB, H_BN) and Z = B^-1 N.
void ChainLdlt::copy_basic_rows(Front& front, Branch& work) {
  const Tableau& tableau = front.tableau;
  const int columns = tableau.columns(), width = tableau.width();
  const int basics = static_cast<int>(work.basic.size()), count = static_cast<int>(work.list.size());
  front.curvature.resize(basics, columns);
  work.u.resize(basics, count);
  work.z.resize(basics, count);
  work.x.resize(count, count);
  const int others = work.x.width();
  for (int b = 0; b < basics; ++b) {
    const double* h = work.symmetric.data() + work.basic[index(b)] * width;
    const double* a = tableau.row(front.basic_rows[index(b)]);
    std::copy_n(h, width, front.curvature.row(b));
    double *u = work.u.row(b), *z = work.z.row(b);
    for (int c = 0; c < count; ++c) {
      const int j = work.list[index(c)];
      u[c] = j < columns ? h[j] : 0;
      z[c] = j < columns ? a[j] : 0;
    }
    std::fill(u + count, u + others, 0.0);
    std::fill(z + count, z + others, 0.0);
  }
}

// Sets the dense matrix of what is left: the reduced Hessian, and the rows without a basic variable.
void ChainLdlt::set_rest(Front& front, Branch& work) {
  const Tableau& tableau = front.tableau;
  const int columns = tableau.columns(), width = tableau.width(), count = static_cast<int>(work.list.size());
  const double* s = work.symmetric.data();
  front.rest.reset(work.list);
  for (int i = 0; i < count; ++i) {
    const int p = work.list[index(i)];
    for (int j = 0; j <= i; ++j) {
      const int q = work.list[index(j)];
      double value = 0;
      if (p < columns && q < columns) {
        value = s[p * width + q] - work.x.row(i)[j] - work.x.row(j)[i];
      } else if (p < columns || q < columns) {
        value = tableau.row(std::max(p, q) - columns)[std::min(p, q)];
      }
      front.rest.row(i)[j] = front.rest.row(j)[i] = value;
    }
  }
}

void ChainLdlt::count_work(const Front& front, Branch& work) {
  const double rows = front.tableau.rows(), width = front.tableau.width(), rest = front.rest.order(),
               basics = static_cast<double>(front.basic_rows.size());
  work.factorisation_work += rows * rows * width + basics * rest * (basics + rest) + rest * rest * rest / 3;
  work.solve_work += 4 * (rows + basics) * width + 2 * rest * rest;
}

// Eliminates the fronts of a branch; stops early once `of_no_use` is set. What remains after a front has at least as
// many negative eigenvalues as the remaining fronts have equality rows (unless it is singular), because its block on
// those rows is zero or negative. Together with the pivots so far, this detects early that there are too many.
ChainLdlt::Outcome ChainLdlt::eliminate(Branch& branch, std::span<const double> values, double threshold,
                                        int most_negative, const std::atomic<bool>& of_no_use) {
  const bool last = &branch == &branches_[kMiddle];
  for (const int k : branch.fronts) {
    if (of_no_use) break;
    Front& front = fronts_[index(k)];
    assemble(front, values, branch);
    if (!reduce(front, last, branch)) return Outcome::kSingular;
    count_work(front, branch);
    branch.negative += front.rest.eliminate(front.rest_summed, threshold);
    // Pivots that are delayed again and again mean that no block has the curvature to eliminate them. The fronts would
    // grow along the chain and the result would be dominated by rounding errors. Reporting the matrix as singular makes
    // the caller regularise it.
    if (front.rest_summed - front.rest.pivots() > kMostDelayed) return Outcome::kSingular;
    if (last) return front.rest.pivots() == front.rest.order() ? Outcome::kDone : Outcome::kSingular;
    if (negative_of_leaves_ + branch.negative > most_negative - front.rows_elsewhere) {
      branch.negative += front.rows_elsewhere;
      return Outcome::kTooManyNegative;
    }
  }
  return Outcome::kDone;
}

// If the branch from the start fails, the branch from the end is ignored even if it finished first. Therefore the
// outcome and the counts do not depend on the number of threads.
ChainLdlt::Outcome ChainLdlt::factorise(std::span<const double> values, double threshold, int most_negative,
                                        const DoBoth& both) {
  negative_of_leaves_ = prepare_leaves(values);
  for (Branch& branch : branches_) branch.negative = 0, branch.factorisation_work = branch.solve_work = 0;
  std::atomic<bool> of_no_use = false;
  const std::atomic<bool> never = false;
  Outcome of_start = Outcome::kDone, of_end = Outcome::kDone;
  auto from_start = [&] {
    of_start = eliminate(branches_[kFromStart], values, threshold, most_negative, never);
    of_no_use = of_start != Outcome::kDone;
  };
  auto from_end = [&] { of_end = eliminate(branches_[kFromEnd], values, threshold, most_negative, of_no_use); };
  both(std::ref(from_start), std::ref(from_end));  // std::ref keeps std::function from allocating memory

  negative_ = negative_of_leaves_;
  factorisation_work_ = solve_work_ = 0;
  const auto count = [&](const Branch& branch) {
    negative_ += branch.negative;
    factorisation_work_ += branch.factorisation_work;
    solve_work_ += branch.solve_work;
  };
  count(branches_[kFromStart]);
  if (of_start != Outcome::kDone) return of_start;
  if (of_end == Outcome::kTooManyNegative) negative_ = negative_of_leaves_;  // its count includes all other fronts
  count(branches_[kFromEnd]);
  if (of_end != Outcome::kDone) return of_end;
  const Outcome of_middle = eliminate(branches_[kMiddle], values, threshold, most_negative, never);
  count(branches_[kMiddle]);
  return of_middle;
}

// Return the entry of the right-hand side b that belongs to column j or row r of the front.
double& ChainLdlt::column_value(const Front& front, std::span<double> b, int j) {
  return b[index(front.column_index[index(j)])];
}
double& ChainLdlt::row_value(const Front& front, std::span<double> b, int r) {
  return b[index(front.row_index[index(r)])];
}

// Forward substitution in one front. With c = B^-1 b_R, the right-hand side of the other variables becomes
//   b_N - H_NB c - Z' (b_B - H_BB c).
void ChainLdlt::solve_forward(const Front& front, std::span<double> b, Rows& vectors) {
  const Tableau& t = front.tableau;
  const int width = t.width(), rows = t.rows(), basics = static_cast<int>(front.basic_rows.size());
  vectors.resize(6, std::max(width, rows));
  double *given = vectors.row(0), *h = vectors.row(1), *a = vectors.row(2), *c = vectors.row(3),
         *c_basic = vectors.row(4), *gradient = vectors.row(5);
  std::fill_n(given, width, 0.0);
  for (const int r : front.basic_rows) given[t.basic(r)] = row_value(front, b, r);
  times_vector(t.data(), rows, width, given, c);
  for (int i = 0; i < basics; ++i) c_basic[i] = c[front.basic_rows[index(i)]];
  transposed_times_vector(front.curvature.data(), basics, width, c_basic, h);
  for (int r = 0; r < rows; ++r) {
    const int j = t.basic(r);
    if (j < 0) row_value(front, b, r) += c[r];
    gradient[r] = j < 0 ? 0 : column_value(front, b, j) - h[j];
  }
  transposed_times_vector(t.data(), rows, width, gradient, a);
  for (int j = 0; j < t.columns(); ++j) {
    if (t.row_of(j) < 0) column_value(front, b, j) -= h[j] + a[j];
  }
}

// Backward substitution in one front: the basic variables are x_B = c - Z x_N, and the multipliers of the rows are
// B'^-1 (b_B - H_BB x_B - H_BN x_N).
void ChainLdlt::solve_backward(const Front& front, std::span<double> b, Rows& vectors) {
  const Tableau& t = front.tableau;
  const int width = t.width(), rows = t.rows(), basics = static_cast<int>(front.basic_rows.size());
  vectors.resize(6, std::max(width, rows));
  double *given = vectors.row(0), *x = vectors.row(1), *a = vectors.row(2), *y = vectors.row(3), *hx = vectors.row(4),
         *gradient = vectors.row(5);
  std::fill_n(given, width, 0.0);
  std::fill_n(x, width, 0.0);
  for (int j = 0; j < t.columns(); ++j) {
    x[j] = column_value(front, b, j);
    given[j] = t.row_of(j) < 0 ? -x[j] : row_value(front, b, t.row_of(j));
  }
  times_vector(t.data(), rows, width, given, y);
  for (const int r : front.basic_rows) x[t.basic(r)] = y[r];
  times_vector(front.curvature.data(), basics, width, x, hx);
  if (basics < rows) {
    for (int r = 0; r < rows; ++r) gradient[r] = row_value(front, b, r);  // multipliers of rows left over
  }
  for (int i = 0; i < basics; ++i) {
    const int r = front.basic_rows[index(i)];
    gradient[r] = column_value(front, b, t.basic(r)) - hx[i];
  }
  transposed_times_vector(t.data(), rows, width, gradient, a);
  for (const int r : front.basic_rows) {
    column_value(front, b, t.basic(r)) = y[r];
    row_value(front, b, r) = a[t.basic(r)];
  }
}

namespace {

// Gives access to the values of the rows of a front's dense matrix (front.rest) within the vector of the whole matrix.
class RestValues {
 public:
  RestValues(std::span<const int> local, std::span<const int> column_index, std::span<const int> row_index,
             std::span<double> values)
      : local_(local), column_index_(column_index), row_index_(row_index), values_(values) {}
  double& operator[](int p) const {
    const int i = local_[index(p)], columns = static_cast<int>(column_index_.size());
    return values_[index(i < columns ? column_index_[index(i)] : row_index_[index(i - columns)])];
  }

 private:
  std::span<const int> local_, column_index_, row_index_;
  std::span<double> values_;
};

}  // namespace

void ChainLdlt::solve_forward(const Branch& branch, std::span<double> b) const {
  const auto value = [&b](int i) -> double& { return b[index(i)]; };
  for (const int k : branch.fronts) {
    const Front& front = fronts_[index(k)];
    for (int l = front.first_leaf; l < front.last_leaf; ++l) {
      const Leaf& leaf = leaves_[index(l)];
      if (leaf.paired) {
        const double t = leaf.inverse_lp * value(leaf.leaf) + leaf.inverse_pp * value(leaf.neighbour);
        for (int e = leaf.others; e < leaf.end; ++e) {
          value(front.columns[index(leaf_entries_[index(e)].column)]) -= leaf_values_[index(e)] * t;
        }
      } else {
        value(leaf.neighbour) -= leaf.a_lp / leaf.a_ll * value(leaf.leaf);
      }
    }
    solve_forward(front, b, branch.vectors);
    const RestValues rest(front.rest.index(), front.column_index, front.row_index, b);
    std::vector<double>& x = branch.rest_values;
    x.resize(index(front.rest.order()));
    for (int p = 0; p < front.rest.order(); ++p) x[index(p)] = rest[p];
    front.rest.solve_forward(x);
    for (int p = 0; p < front.rest.order(); ++p) rest[p] = x[index(p)];
  }
}

void ChainLdlt::solve_backward(const Branch& branch, std::span<double> b) const {
  const auto value = [&b](int i) -> double& { return b[index(i)]; };
  for (std::size_t at = branch.fronts.size(); at-- > 0;) {
    const Front& front = fronts_[index(branch.fronts[at])];
    const RestValues rest(front.rest.index(), front.column_index, front.row_index, b);
    std::vector<double>& x = branch.rest_values;
    x.resize(index(front.rest.order()));
    for (int p = 0; p < front.rest.order(); ++p) x[index(p)] = rest[p];
    front.rest.solve_backward(x);
    // Rows passed on to later fronts are already solved there.
    for (int p = 0; p < front.rest.pivots(); ++p) rest[p] = x[index(p)];
    solve_backward(front, b, branch.vectors);
    for (int l = front.first_leaf; l < front.last_leaf; ++l) {
      const Leaf& leaf = leaves_[index(l)];
      if (leaf.paired) {
        double p = value(leaf.neighbour);
        for (int e = leaf.others; e < leaf.end; ++e) {
          p -= leaf_values_[index(e)] * value(front.columns[index(leaf_entries_[index(e)].column)]);
        }
        const double own = value(leaf.leaf);
        value(leaf.leaf) = leaf.inverse_ll * own + leaf.inverse_lp * p;
        value(leaf.neighbour) = leaf.inverse_lp * own + leaf.inverse_pp * p;
      } else {
        value(leaf.leaf) = (value(leaf.leaf) - leaf.a_lp * value(leaf.neighbour)) / leaf.a_ll;
      }
    }
  }
}

// The two outer branches share only the border. To let them run concurrently, the one from the end adds to a border of
// its own.
void ChainLdlt::solve(std::span<double> b, const DoBoth& both) const {
  std::copy(b.begin(), b.end(), values_.begin());
  const std::span<double> values(values_), border = values.subspan(index(size_));
  std::fill(border.begin(), border.end(), 0.0);
  auto forward_from_start = [&] { solve_forward(branches_[kFromStart], values); };
  auto forward_from_end = [&] { solve_forward(branches_[kFromEnd], values); };
  both(std::ref(forward_from_start), std::ref(forward_from_end));
  for (std::size_t i = 0; i < border.size(); ++i) values[index(border_[i])] += border[i];
  solve_forward(branches_[kMiddle], values);
  solve_backward(branches_[kMiddle], values);
  for (std::size_t i = 0; i < border.size(); ++i) border[i] = values[index(border_[i])];
  auto back_to_start = [&] { solve_backward(branches_[kFromStart], values); };
  auto back_to_end = [&] { solve_backward(branches_[kFromEnd], values); };
  both(std::ref(back_to_start), std::ref(back_to_end));
  std::copy_n(values.begin(), b.size(), b.begin());
}

}  // namespace fjr
