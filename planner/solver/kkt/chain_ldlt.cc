#include "planner/solver/kkt/chain_ldlt.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace fjr {
namespace {

// A pivot below this share of the matrix's largest entry is a zero.
constexpr double kZero = 1e-20;

// Pivots that bound growth this well are taken first; the caller's threshold is what is accepted before delaying.
constexpr double kComfortable = 1e-2;

constexpr int kMostDelayed = 40;

// A slack whose own curvature is beyond this is better eliminated alone: the pair's Schur complement would carry the
// large number into the states' block and lose their digits to it.
constexpr double kLargestCondensed = 1e4;

double sum(std::span<const double> values, const auto& entries) {
  double total = 0;
  for (const auto& e : entries) total += values[static_cast<std::size_t>(e.value)];
  return total;
}

// The two loops that take most of the time, compiled for the vector units of newer processors too; the loader chooses.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define FJR_VECTORISED __attribute__((target_clones("arch=haswell", "default")))
#else
#define FJR_VECTORISED
#endif

FJR_VECTORISED void subtract_one(double* a, int n, int p, double d) {
  const auto column = [a, n](int j) { return a + static_cast<std::ptrdiff_t>(j) * n; };
  double* lp = column(p);
  const double inverse = 1 / d;
  for (int j = p + 1; j < n; ++j) {
    const double l = lp[j] * inverse;
    if (l == 0) continue;
    double* __restrict to = column(j);
    const double* __restrict from = lp;
    for (int i = j; i < n; ++i) to[i] -= from[i] * l;
  }
  for (int i = p + 1; i < n; ++i) lp[i] *= inverse;
}

FJR_VECTORISED void subtract_two(double* a, int n, int p, double d0, double e0, double d1) {
  const auto column = [a, n](int j) { return a + static_cast<std::ptrdiff_t>(j) * n; };
  double *l0 = column(p), *l1 = column(p + 1);
  const double inverse = 1 / (d0 * d1 - e0 * e0), b00 = d1 * inverse, b01 = -e0 * inverse, b11 = d0 * inverse;
  for (int j = p + 2; j < n; ++j) {
    const double u = b00 * l0[j] + b01 * l1[j], v = b01 * l0[j] + b11 * l1[j];
    if (u == 0 && v == 0) continue;
    double* __restrict to = column(j);
    const double* __restrict from0 = l0, * __restrict from1 = l1;
    for (int i = j; i < n; ++i) to[i] -= from0[i] * u + from1[i] * v;
  }
  for (int i = p + 2; i < n; ++i) {
    const double u = b00 * l0[i] + b01 * l1[i], v = b01 * l0[i] + b11 * l1[i];
    l0[i] = u;
    l1[i] = v;
  }
  l0[p + 1] = 0;
}

FJR_VECTORISED double largest_of(const double* values, int count) {
  // Several maxima side by side: one alone would wait for each comparison.
  double best[8] = {};
  int i = 0;
  for (; i + 8 <= count; i += 8) {
    for (int lane = 0; lane < 8; ++lane) {
      const double size = std::fabs(values[i + lane]);
      best[lane] = size > best[lane] ? size : best[lane];
    }
  }
  for (; i < count; ++i) best[0] = std::max(best[0], std::fabs(values[i]));
  for (int lane = 1; lane < 8; ++lane) best[0] = std::max(best[0], best[lane]);
  return best[0];
}

// Lower triangle of a dense symmetric matrix in column-major storage, with the operations elimination needs.
class Dense {
 public:
  Dense(double* data, int order) : a_(data), n_(order) {}
  double& at(int i, int j) {
    return a_[static_cast<std::size_t>(j) * static_cast<std::size_t>(n_) + static_cast<std::size_t>(i)];
  }
  double& symmetric(int i, int j) { return i >= j ? at(i, j) : at(j, i); }
  double* column(int j) { return &at(0, j); }

  // Exchanges rows and columns p < q.
  void exchange(int p, int q) {
    if (p == q) return;
    for (int j = 0; j < p; ++j) std::swap(at(p, j), at(q, j));
    std::swap(at(p, p), at(q, q));
    for (int i = p + 1; i < q; ++i) std::swap(at(i, p), at(q, i));
    for (int i = q + 1; i < n_; ++i) std::swap(at(i, p), at(i, q));
  }

  // Subtracts from everything right of column p what eliminating it with the pivot d leaves there, and divides the
  // column.
  void eliminate_one(int p, double d) { subtract_one(a_, n_, p, d); }
  // The same for columns p and p + 1 with the pivot block (d0 e0; e0 d1).
  void eliminate_two(int p, double d0, double e0, double d1) { subtract_two(a_, n_, p, d0, e0, d1); }

  // Largest magnitude in row/column c from row `from` on, c itself apart.
  double largest(int c, int from) {
    double best = largest_of(column(c) + c + 1, n_ - c - 1);
    for (int j = from; j < c; ++j) best = std::max(best, std::abs(at(c, j)));
    return best;
  }
  // The same with `except` left out too.
  double largest(int c, int from, int except) {
    const double kept = symmetric(c, except);
    symmetric(c, except) = 0;
    const double best = largest(c, from);
    symmetric(c, except) = kept;
    return best;
  }
  // The row below `limit` where it is.
  int where_largest(int c, int from, int limit) {
    int where = -1;
    double best = -1;
    for (int i = from; i < limit; ++i) {
      if (i == c || std::abs(symmetric(i, c)) <= best) continue;
      best = std::abs(symmetric(i, c));
      where = i;
    }
    return where;
  }

 private:
  double* a_;
  int n_;
};

}  // namespace

void ChainLdlt::analyse(int size, std::span<const int> rows, std::span<const int> cols, std::span<const int> stage,
                        int stages) {
  size_ = size;
  fronts_.clear();
  leaves_.clear();
  border_.clear();
  const auto at = [](const auto& v, int i) -> decltype(auto) { return v[static_cast<std::size_t>(i)]; };
  fronts_.resize(static_cast<std::size_t>(stages));

  // Neighbours, to find leaves; and who is seen by the next stage.
  std::vector<int> only_neighbour(static_cast<std::size_t>(size), -1), degree(static_cast<std::size_t>(size), 0);
  std::vector<bool> seen_later(static_cast<std::size_t>(size), false);
  for (std::size_t e = 0; e < rows.size(); ++e) {
    const int i = rows[e], j = cols[e];
    if (i == j) continue;
    for (const auto& [a, b] : {std::pair{i, j}, std::pair{j, i}}) {
      if (at(only_neighbour, a) != b) ++degree[static_cast<std::size_t>(a)];
      only_neighbour[static_cast<std::size_t>(a)] = b;
    }
    const int si = at(stage, i), sj = at(stage, j);
    if (si == stages || sj == stages || si == sj) continue;
    if (std::abs(si - sj) != 1) {
      throw std::invalid_argument("the matrix is no chain: an entry joins stages " + std::to_string(si) + " and " +
                                  std::to_string(sj));
    }
    seen_later[static_cast<std::size_t>(si < sj ? i : j)] = true;
  }

  leaf_role_.assign(static_cast<std::size_t>(size), -1);
  for (int i = 0; i < size; ++i) {
    const int p = at(only_neighbour, i);
    if (at(degree, i) != 1 || at(stage, i) == stages || at(stage, i) != at(stage, p)) continue;
    if (seen_later[static_cast<std::size_t>(p)] || at(leaf_role_, p) >= 0 || at(leaf_role_, i) >= 0) continue;
    const int role = static_cast<int>(leaves_.size());
    leaf_role_[static_cast<std::size_t>(i)] = leaf_role_[static_cast<std::size_t>(p)] = role;
    Leaf leaf;
    leaf.leaf = i;
    leaf.neighbour = p;
    leaf.front = at(stage, i);
    leaves_.push_back(std::move(leaf));
    fronts_[static_cast<std::size_t>(at(stage, i))].leaves.push_back(role);
  }
  // Two neighbours of leaves that see each other cannot both go first.
  for (std::size_t e = 0; e < rows.size(); ++e) {
    const int i = rows[e], j = cols[e], a = at(leaf_role_, i), b = at(leaf_role_, j);
    if (a >= 0 && b >= 0 && a != b) throw std::invalid_argument("two inequality rows are coupled directly");
  }

  for (int i = 0; i < size; ++i) {
    if (at(stage, i) == stages) {
      border_.push_back(i);
    } else if (at(leaf_role_, i) < 0) {
      Front& front = fronts_[static_cast<std::size_t>(at(stage, i))];
      (seen_later[static_cast<std::size_t>(i)] ? front.later : front.own).push_back(i);
    }
  }
  for (std::size_t e = 0; e < rows.size(); ++e) {
    const int i = rows[e], j = cols[e];
    const Entry entry{static_cast<int>(e), i, j};
    const int role = std::max(at(leaf_role_, i), at(leaf_role_, j));
    if (role >= 0) {
      Leaf& leaf = leaves_[static_cast<std::size_t>(role)];
      if (i == j) {
        (i == leaf.leaf ? leaf.own : leaf.diagonal).push_back(entry);
      } else if (i == leaf.leaf || j == leaf.leaf) {
        leaf.coupling.push_back(entry);
      } else {
        leaf.others.push_back({entry.value, leaf.neighbour, i == leaf.neighbour ? j : i});
      }
      continue;
    }
    int k = std::max(at(stage, i), at(stage, j));
    if (k == stages) k = std::min(at(stage, i), at(stage, j));  // with the border: where the other index first appears
    fronts_[std::min(static_cast<std::size_t>(k), fronts_.size() - 1)].entries.push_back(entry);
  }
  local_.assign(static_cast<std::size_t>(size), -1);
  work_.assign(static_cast<std::size_t>(size), 0);
}

void ChainLdlt::prepare_leaves(std::span<const double> values) {
  for (Leaf& leaf : leaves_) {
    leaf.a_ll = sum(values, leaf.own);
    leaf.a_lp = sum(values, leaf.coupling);
    leaf.a_pp = sum(values, leaf.diagonal);
    leaf.weights.clear();
    for (const Entry& e : leaf.others) leaf.weights.push_back(values[static_cast<std::size_t>(e.value)]);
    const double determinant = leaf.a_ll * leaf.a_pp - leaf.a_lp * leaf.a_lp;
    leaf.paired = std::abs(leaf.a_ll) <= kLargestCondensed * leaf.a_lp * leaf.a_lp && determinant < 0;
    if (leaf.paired) {
      leaf.inverse_ll = leaf.a_pp / determinant;
      leaf.inverse_lp = -leaf.a_lp / determinant;
      leaf.inverse_pp = leaf.a_ll / determinant;
      ++negative_;  // determinant < 0: one eigenvalue of each sign
    } else if (leaf.a_ll < 0) {
      ++negative_;
    }
  }
}

// Lays out front k - rows eliminated here first, then what stays - and adds its entries and the previous front's rest.
void ChainLdlt::assemble(std::size_t k, std::span<const double> values) {
  Front& front = fronts_[k];
  const Front* previous = k > 0 ? &fronts_[k - 1] : nullptr;
  const bool final_front = k + 1 == fronts_.size();
  front.index.clear();
  const auto append = [&](int i) {
    if (local_[static_cast<std::size_t>(i)] >= 0) return;
    local_[static_cast<std::size_t>(i)] = static_cast<int>(front.index.size());
    front.index.push_back(i);
  };
  for (const int i : border_) local_[static_cast<std::size_t>(i)] = 0;  // held back: they come last
  if (previous != nullptr) {
    for (std::size_t r = static_cast<std::size_t>(previous->pivots); r < previous->index.size(); ++r)
      append(previous->index[r]);
  }
  for (const int i : front.own) append(i);
  for (const int l : front.leaves) {
    if (!leaves_[static_cast<std::size_t>(l)].paired) append(leaves_[static_cast<std::size_t>(l)].neighbour);
  }
  for (const int i : border_) local_[static_cast<std::size_t>(i)] = -1;
  int summed = static_cast<int>(front.index.size());
  for (const int i : front.later) append(i);
  for (const int i : border_) append(i);
  front.order = static_cast<int>(front.index.size());
  if (final_front) summed = front.order;
  front.pivots = summed;  // eliminate() lowers it by what is delayed

  const auto order = static_cast<std::size_t>(front.order);
  front.matrix.assign(order * order, 0);
  Dense a(front.matrix.data(), front.order);
  const auto row = [this](int i) { return local_[static_cast<std::size_t>(i)]; };
  for (const Entry& e : front.entries) a.symmetric(row(e.row), row(e.col)) += values[static_cast<std::size_t>(e.value)];
  for (const int l : front.leaves) {
    const Leaf& leaf = leaves_[static_cast<std::size_t>(l)];
    if (leaf.paired) {
      for (std::size_t s = 0; s < leaf.others.size(); ++s) {
        for (std::size_t t = 0; t < leaf.others.size(); ++t) {
          const int i = row(leaf.others[s].col), j = row(leaf.others[t].col);
          if (i >= j) a.at(i, j) -= leaf.weights[s] * leaf.inverse_pp * leaf.weights[t];
        }
      }
    } else {
      const int p = row(leaf.neighbour);
      a.at(p, p) += leaf.a_pp - leaf.a_lp * leaf.a_lp / leaf.a_ll;
      for (std::size_t s = 0; s < leaf.others.size(); ++s) a.symmetric(p, row(leaf.others[s].col)) += leaf.weights[s];
    }
  }
  if (previous != nullptr) {
    Dense rest(const_cast<double*>(previous->matrix.data()), previous->order);
    for (int j = previous->pivots; j < previous->order; ++j) {
      const int to = row(previous->index[static_cast<std::size_t>(j)]);
      for (int i = j; i < previous->order; ++i) {
        a.symmetric(row(previous->index[static_cast<std::size_t>(i)]), to) += rest.at(i, j);
      }
    }
  }
  for (const int i : front.index) local_[static_cast<std::size_t>(i)] = -1;
}

// Eliminates as many of the first `fully_summed` rows as find a good pivot; returns how many.
int ChainLdlt::eliminate(Front& front, int fully_summed, double threshold) {
  const int n = front.order;
  const bool last = fully_summed == n;
  Dense a(front.matrix.data(), n);
  front.d.assign(static_cast<std::size_t>(n), 0);
  front.e.assign(static_cast<std::size_t>(n), 0);
  const auto swap_rows = [&](int p, int q) {
    a.exchange(std::min(p, q), std::max(p, q));
    std::swap(front.index[static_cast<std::size_t>(p)], front.index[static_cast<std::size_t>(q)]);
  };
  int p = 0, candidate = 0;
  double wanted = kComfortable;
  while (p < fully_summed) {
    if (p + candidate >= fully_summed) {  // nobody left passes
      if (wanted <= threshold) break;     // delayed
      wanted = threshold;
      candidate = 0;
    }
    const int c = p + candidate;
    const double off = a.largest(c, p);
    const double own = std::abs(a.at(c, c));
    if (own == 0 && off == 0) {
      if (!last) {
        ++candidate;
        continue;
      }
      return p;  // a zero row: singular
    }
    if (own >= wanted * off && own > kZero) {  // 1 x 1
      swap_rows(p, c);
      const double d = a.at(p, p);
      front.d[static_cast<std::size_t>(p)] = d;
      negative_ += d < 0;
      a.eliminate_one(p, d);
      ++p;
      candidate = 0;
      wanted = kComfortable;
      continue;
    }
    int r = a.where_largest(c, p, fully_summed);
    if (r >= 0) {  // 2 x 2 with the fully summed row it couples to most
      const double x = a.at(c, c), y = a.symmetric(c, r), z = a.at(r, r), determinant = x * z - y * y;
      const double off_c = a.largest(c, p, r), off_r = a.largest(r, p, c);
      // Growth of the inverse times the rest, row by row (Duff & Reid's test).
      const double growth =
          std::max(std::abs(z) * off_c + std::abs(y) * off_r, std::abs(y) * off_c + std::abs(x) * off_r);
      if (std::abs(determinant) > kZero && growth * wanted <= std::abs(determinant)) {
        swap_rows(p, c);
        if (r == p) r = c;
        swap_rows(p + 1, r);
        const double d0 = a.at(p, p), e0 = a.at(p + 1, p), d1 = a.at(p + 1, p + 1), det = d0 * d1 - e0 * e0;
        front.d[static_cast<std::size_t>(p)] = d0;
        front.d[static_cast<std::size_t>(p) + 1] = d1;
        front.e[static_cast<std::size_t>(p)] = e0;
        negative_ += det < 0 ? 1 : (d0 < 0 ? 2 : 0);
        a.eliminate_two(p, d0, e0, d1);
        p += 2;
        candidate = 0;
        wanted = kComfortable;
        continue;
      }
    }
    ++candidate;
  }
  return p;
}

bool ChainLdlt::factorise(std::span<const double> values, double threshold) {
  negative_ = 0;
  prepare_leaves(values);
  for (std::size_t k = 0; k < fronts_.size(); ++k) {
    assemble(k, values);
    Front& front = fronts_[k];
    const int summed = front.pivots;
    front.pivots = eliminate(front, summed, threshold);
    // Pivots that pile up along the chain mean that no stage has the curvature to place them: the fronts would grow
    // with the chain's length, and what comes out at its end would be noise. The caller's perturbation is the cure.
    if (summed - front.pivots > kMostDelayed) return false;
    if (k + 1 < fronts_.size()) continue;
    // Nothing follows: what is left takes the best pivot there is, or the matrix is singular.
    if (front.pivots < front.order) return false;
  }
  return true;
}

void ChainLdlt::solve(std::span<double> b) const {
  const auto value = [&b](int i) -> double& { return b[static_cast<std::size_t>(i)]; };
  for (const Leaf& leaf : leaves_) {
    if (leaf.paired) {
      const double t = leaf.inverse_lp * value(leaf.leaf) + leaf.inverse_pp * value(leaf.neighbour);
      for (std::size_t s = 0; s < leaf.others.size(); ++s) value(leaf.others[s].col) -= leaf.weights[s] * t;
    } else {
      value(leaf.neighbour) -= leaf.a_lp / leaf.a_ll * value(leaf.leaf);
    }
  }
  const auto gather = [&](const Front& f) {
    for (int r = 0; r < f.order; ++r) work_[static_cast<std::size_t>(r)] = value(f.index[static_cast<std::size_t>(r)]);
  };
  const auto scatter = [&](const Front& f) {
    for (int r = 0; r < f.order; ++r) value(f.index[static_cast<std::size_t>(r)]) = work_[static_cast<std::size_t>(r)];
  };
  const auto column = [](const Front& f, int p) {
    return f.matrix.data() + static_cast<std::size_t>(p) * static_cast<std::size_t>(f.order);
  };
  for (const Front& f : fronts_) {
    gather(f);
    for (int p = 0; p < f.pivots; ++p) {
      const double* l = column(f, p);
      const double x = work_[static_cast<std::size_t>(p)];
      const int below = f.e[static_cast<std::size_t>(p)] != 0 ? p + 2 : p + 1;
      for (int i = below; i < f.order; ++i) work_[static_cast<std::size_t>(i)] -= l[i] * x;
    }
    scatter(f);
  }
  for (std::size_t k = fronts_.size(); k-- > 0;) {
    const Front& f = fronts_[k];
    gather(f);
    for (int p = 0; p < f.pivots; ++p) {
      const auto q = static_cast<std::size_t>(p);
      if (f.e[q] == 0) {
        work_[q] /= f.d[q];
        continue;
      }
      const double det = f.d[q] * f.d[q + 1] - f.e[q] * f.e[q];
      const double x = work_[q], y = work_[q + 1];
      work_[q] = (f.d[q + 1] * x - f.e[q] * y) / det;
      work_[q + 1] = (f.d[q] * y - f.e[q] * x) / det;
      ++p;
    }
    for (int p = f.pivots - 1; p >= 0; --p) {
      const double* l = column(f, p);
      const int below = f.e[static_cast<std::size_t>(p)] != 0 ? p + 2 : p + 1;
      double x = work_[static_cast<std::size_t>(p)];
      for (int i = below; i < f.order; ++i) x -= l[i] * work_[static_cast<std::size_t>(i)];
      work_[static_cast<std::size_t>(p)] = x;
    }
    // Rows passed on to later fronts are already solved there.
    for (int r = 0; r < f.pivots; ++r) value(f.index[static_cast<std::size_t>(r)]) = work_[static_cast<std::size_t>(r)];
  }
  for (const Leaf& leaf : leaves_) {
    if (leaf.paired) {
      double p = value(leaf.neighbour);
      for (std::size_t s = 0; s < leaf.others.size(); ++s) p -= leaf.weights[s] * value(leaf.others[s].col);
      const double l = value(leaf.leaf);
      value(leaf.leaf) = leaf.inverse_ll * l + leaf.inverse_lp * p;
      value(leaf.neighbour) = leaf.inverse_lp * l + leaf.inverse_pp * p;
    } else {
      value(leaf.leaf) = (value(leaf.leaf) - leaf.a_lp * value(leaf.neighbour)) / leaf.a_ll;
    }
  }
}

}  // namespace fjr
