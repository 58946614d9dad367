// The symbolic analysis of ChainLdlt: determines the entries, columns and rows of each front, once per sparsity
// pattern.
#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>

#include "planner/nlp/chain/chain_ldlt.h"

namespace fjr {
namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

// Sorts the numbers 0, 1, ... by their group, in increasing order within a group (a counting sort).
class Groups {
 public:
  Groups(const std::vector<int>& group_of, std::size_t groups) : begin_(groups + 1, 0), items_(group_of.size()) {
    for (const int g : group_of) ++begin_[index(g) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    std::vector<int> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < group_of.size(); ++i) items_[index(next[index(group_of[i])]++)] = static_cast<int>(i);
  }
  std::span<const int> operator[](std::size_t group) const {
    return std::span(items_).subspan(index(begin_[group]), index(begin_[group + 1] - begin_[group]));
  }

 private:
  std::vector<int> begin_, items_;
};

}  // namespace

// What the pattern tells of each index.
struct ChainLdlt::Pattern {
  Pattern(std::span<const int> entry_rows, std::span<const int> entry_cols, const ChainStructure& structure);

  std::span<const int> rows, cols;  // of the entries
  const std::vector<int>& block;    // of each index; the border's have block `blocks`
  int blocks;
  std::vector<int> only_neighbour, degree;  // the last neighbour that was seen, and how often it changed
  std::vector<int> entries;                 // number of its entries
  std::vector<char> seen_later;             // whether the next block is coupled to it
  // Only those equality rows are treated as such that lie within one block and are not coupled to one another.
  std::vector<char> equality, sees_equality;

 private:
  void find_neighbours();
  void find_equality_rows(const std::vector<bool>& given);
};

ChainLdlt::Pattern::Pattern(std::span<const int> entry_rows, std::span<const int> entry_cols,
                            const ChainStructure& structure)
    : rows(entry_rows),
      cols(entry_cols),
      block(structure.block),
      blocks(structure.blocks),
      only_neighbour(block.size(), -1),
      degree(block.size(), 0),
      entries(block.size(), 0),
      seen_later(block.size(), false),
      sees_equality(block.size(), false) {
  find_neighbours();
  find_equality_rows(structure.equality);
}

void ChainLdlt::Pattern::find_neighbours() {
  for (std::size_t e = 0; e < rows.size(); ++e) {
    const int i = rows[e], j = cols[e];
    ++entries[index(i)];
    ++entries[index(j)];
    if (i == j) continue;
    for (const auto& [a, b] : {std::pair{i, j}, std::pair{j, i}}) {
      if (only_neighbour[index(a)] != b) ++degree[index(a)];
      only_neighbour[index(a)] = b;
    }
    const int si = block[index(i)], sj = block[index(j)];
    if (si == blocks || sj == blocks || si == sj) continue;
    if (std::abs(si - sj) != 1) {
      throw std::invalid_argument("the matrix is no chain: an entry joins blocks " + std::to_string(si) + " and " +
                                  std::to_string(sj));
    }
    seen_later[index(si < sj ? i : j)] = true;
  }
}

void ChainLdlt::Pattern::find_equality_rows(const std::vector<bool>& given) {
  equality.assign(given.begin(), given.end());
  equality.resize(block.size(), false);
  for (std::size_t i = 0; i < block.size(); ++i) equality[i] = equality[i] && block[i] != blocks && !seen_later[i];
  for (std::size_t e = 0; e < rows.size(); ++e) {
    if (rows[e] != cols[e] && equality[index(rows[e])]) equality[index(cols[e])] = false;
  }
  for (std::size_t e = 0; e < rows.size(); ++e) {
    if (equality[index(cols[e])]) sees_equality[index(rows[e])] = true;
    if (equality[index(rows[e])]) sees_equality[index(cols[e])] = true;
  }
}

// Finds the leaves and sorts them by front. Returns for each index the number of the leaf that it or its neighbour is,
// or -1.
std::vector<int> ChainLdlt::find_leaves(const Pattern& of) {
  std::vector<int> leaf_role(of.block.size(), -1);
  for (int i = 0; i < size_; ++i) {
    const int p = of.only_neighbour[index(i)];
    if (of.degree[index(i)] != 1 || of.block[index(i)] == of.blocks || of.block[index(i)] != of.block[index(p)])
      continue;
    if (of.seen_later[index(p)] || of.sees_equality[index(p)] || of.sees_equality[index(i)]) continue;
    if (leaf_role[index(p)] >= 0 || leaf_role[index(i)] >= 0) continue;
    leaf_role[index(i)] = leaf_role[index(p)] = static_cast<int>(leaves_.size());
    leaves_.push_back({.leaf = i, .neighbour = p});
  }
  std::stable_sort(leaves_.begin(), leaves_.end(),
                   [&](const Leaf& a, const Leaf& b) { return of.block[index(a.leaf)] < of.block[index(b.leaf)]; });
  for (int l = 0; l < static_cast<int>(leaves_.size()); ++l) {
    const Leaf& leaf = leaves_[index(l)];
    leaf_role[index(leaf.leaf)] = leaf_role[index(leaf.neighbour)] = l;
    ++fronts_[index(of.block[index(leaf.leaf)])].last_leaf;  // only counts at first
  }
  for (std::size_t k = 0; k < fronts_.size(); ++k) {
    fronts_[k].first_leaf = k > 0 ? fronts_[k - 1].last_leaf : 0;
    fronts_[k].last_leaf += fronts_[k].first_leaf;
  }
  return leaf_role;
}

// Distributes the indices over fronts and border, as columns or rows; leaves apart.
void ChainLdlt::set_fronts(const Pattern& of, const std::vector<int>& leaf_role) {
  border_.clear();
  std::vector<std::vector<int>> shared(index(of.blocks)), own(index(of.blocks));  // coupled to the next block; not
  for (int i = 0; i < size_; ++i) {
    if (leaf_role[index(i)] >= 0) continue;
    const int k = of.block[index(i)];
    if (k == of.blocks) {
      border_.push_back(i);
    } else if (of.equality[index(i)]) {
      fronts_[index(k)].rows.push_back(i);
    } else {
      (of.seen_later[index(i)] ? shared : own)[index(k)].push_back(i);
    }
  }
  for (Front& front : fronts_) {
    // Short rows come first, because their elimination causes less fill-in in the rows that are pivoted later.
    std::stable_sort(front.rows.begin(), front.rows.end(),
                     [&](int a, int b) { return of.entries[index(a)] < of.entries[index(b)]; });
  }
  set_branches(shared, own);
}

// Returns per entry the number of the front that it belongs to, or the number of fronts plus that of a leaf.
std::vector<int> ChainLdlt::owners(const Pattern& of, const std::vector<int>& leaf_role) {
  std::vector<int> belongs_to;
  belongs_to.reserve(of.rows.size());
  for (std::size_t e = 0; e < of.rows.size(); ++e) {
    const int i = of.rows[e], j = of.cols[e], si = of.block[index(i)], sj = of.block[index(j)];
    const int role = std::max(leaf_role[index(i)], leaf_role[index(j)]);
    if (role >= 0) {
      if (std::min(leaf_role[index(i)], leaf_role[index(j)]) >= 0 && leaf_role[index(i)] != leaf_role[index(j)]) {
        throw std::invalid_argument("two inequality rows are coupled directly");
      }
      belongs_to.push_back(of.blocks + role);
      continue;
    }
    int k = std::max(si, sj);
    if (k == of.blocks) k = std::min(si, sj);  // one index is in the border: the block of the other decides
    belongs_to.push_back(std::min(k, of.blocks - 1));
  }
  return belongs_to;
}

// Positions of a front's entries. place: of each index, its column or row in the front.
void ChainLdlt::set_entries(const Pattern& of, std::span<const int> entries, const std::vector<int>& place,
                            Front& front) {
  for (const int e : entries) {
    int i = of.rows[index(e)], j = of.cols[index(e)];
    if (of.equality[index(j)]) std::swap(i, j);
    const int p = place[index(i)], q = place[index(j)];
    const Entry entry{e, p * front.width + q, q * front.width + p};
    if (of.equality[index(i)]) {
      (i == j ? front.row_diagonal : front.coupling).push_back(entry);
    } else {
      (i == j ? front.diagonal : front.symmetric).push_back(entry);
    }
  }
}

// Lists the entries of a leaf by their kind.
void ChainLdlt::set_leaf_entries(const Pattern& of, std::span<const int> entries, const std::vector<int>& place,
                                 Leaf& leaf) {
  const auto add = [&](auto&& belongs) {
    for (const int e : entries) {
      const int i = of.rows[index(e)], j = of.cols[index(e)];
      const int column = place[index(i == leaf.neighbour ? j : i)];
      if (belongs(i, j)) leaf_entries_.push_back({e, column});
    }
    return static_cast<int>(leaf_entries_.size());
  };
  const auto is = [&](int i, int j, int a, int b) { return (i == a && j == b) || (i == b && j == a); };
  leaf.own = static_cast<int>(leaf_entries_.size());
  leaf.coupling = add([&](int i, int j) { return is(i, j, leaf.leaf, leaf.leaf); });
  leaf.diagonal = add([&](int i, int j) { return is(i, j, leaf.leaf, leaf.neighbour); });
  leaf.others = add([&](int i, int j) { return is(i, j, leaf.neighbour, leaf.neighbour); });
  leaf.end = add([&](int i, int j) { return i != leaf.leaf && j != leaf.leaf && i != j; });
}

void ChainLdlt::analyse(std::span<const int> rows, std::span<const int> cols, const ChainStructure& structure) {
  if (structure.blocks < 1) throw std::invalid_argument("a chain has a block at least");
  size_ = static_cast<int>(structure.block.size());
  fronts_.assign(index(structure.blocks), {});
  leaves_.clear();
  leaf_entries_.clear();
  const Pattern pattern(rows, cols, structure);
  const std::vector<int> leaf_role = find_leaves(pattern);
  set_fronts(pattern, leaf_role);
  const Groups entries_of(owners(pattern, leaf_role), fronts_.size() + leaves_.size());
  leaf_entries_.reserve(rows.size());
  // The position of an index is known only within the front at hand.
  std::vector<int> place(structure.block.size() + border_.size(), -1);
  for (std::size_t k = 0; k < fronts_.size(); ++k) {
    Front& front = fronts_[k];
    for (int c = 0; c < static_cast<int>(front.columns.size()); ++c) place[index(front.columns[index(c)])] = c;
    const int first_of_border = static_cast<int>(front.columns.size() - border_.size());
    for (int c = 0; c < static_cast<int>(border_.size()); ++c) place[index(border_[index(c)])] = first_of_border + c;
    for (int r = 0; r < static_cast<int>(front.rows.size()); ++r) place[index(front.rows[index(r)])] = r;
    set_entries(pattern, entries_of[k], place, front);
    for (int l = front.first_leaf; l < front.last_leaf; ++l) {
      set_leaf_entries(pattern, entries_of[fronts_.size() + index(l)], place, leaves_[index(l)]);
    }
  }
  leaf_values_.assign(leaf_entries_.size(), 0);
}

// Determines the columns of each front and the child fronts that pass them on. `shared` lists per block the indices
// that are coupled to the next block, `own` those that are coupled to no other block.
void ChainLdlt::set_branches(const std::vector<std::vector<int>>& shared, const std::vector<std::vector<int>>& own) {
  const int blocks = static_cast<int>(fronts_.size()), middle = blocks / 2;
  branches_ = {};
  int all_rows = 0;
  for (const Front& front : fronts_) all_rows += static_cast<int>(front.rows.size());
  const auto lay_out = [&](Branch& branch, int k, std::vector<int> children, const std::vector<int>& passed_on) {
    branch.fronts.push_back(k);
    Front& front = fronts_[index(k)];
    for (const int child : children) {
      front.children.push_back({child, static_cast<int>(front.columns.size())});
      const std::vector<int>& from_child = shared[index(std::min(k, child))];
      front.columns.insert(front.columns.end(), from_child.begin(), from_child.end());
    }
    front.columns.insert(front.columns.end(), own[index(k)].begin(), own[index(k)].end());
    front.summed = static_cast<int>(front.columns.size());
    front.later = static_cast<int>(passed_on.size());
    front.columns.insert(front.columns.end(), passed_on.begin(), passed_on.end());
    for (int i = 0; i < static_cast<int>(border_.size()); ++i) {
      front.columns.push_back(&branch == &branches_[kFromEnd] ? size_ + i : border_[index(i)]);
    }
    front.width = padded(static_cast<int>(front.columns.size()));
    branch.rows += static_cast<int>(front.rows.size());
    front.rows_elsewhere = all_rows - branch.rows;
  };
  for (int k = 0; k < middle; ++k) {
    lay_out(branches_[kFromStart], k, k > 0 ? std::vector{k - 1} : std::vector<int>{}, shared[index(k)]);
  }
  for (int k = blocks - 1; k > middle; --k) {
    lay_out(branches_[kFromEnd], k, k < blocks - 1 ? std::vector{k + 1} : std::vector<int>{}, shared[index(k - 1)]);
  }
  std::vector<int> children;
  if (middle > 0) children.push_back(middle - 1);
  if (middle < blocks - 1) children.push_back(middle + 1);
  lay_out(branches_[kMiddle], middle, children, {});
  values_.assign(index(size_) + border_.size(), 0);
}

}  // namespace fjr
