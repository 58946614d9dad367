// Which variables the entries of Jacobian and Hessian of an interval belong to. It is the same in every interval, and
// is found once; a transcription writes the pattern and the values by these lists, in their order.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "common/dual.h"
#include "planner/collocation/scheme.h"

namespace fjr {

struct EntryVariable {  // of an interval: state `at` of the node before it, or the variable `at` after its first one
  enum Where { kNode, kInterval, kDuration } where;
  int at;
};
struct DefectEntry {  // own - h A df/dinput, and with kDuration: -fraction sum_j A f_j
  int defect, row, stage, input;
  double own, factor;  // factor: of A and of the input's share of the variable
  EntryVariable of;
};
struct InputEntry {  // coefficient d/dinput
  int input;
  double coefficient;
  EntryVariable of;
};
struct PairEntry {  // coefficient d2/dinputs, at `packed` in a lower triangle
  std::size_t packed;
  double coefficient;
  EntryVariable of, with;
};

// kX states, kU controls and kC path rows; inputs of a stage are its states, then its controls.
template <int kX, int kU, int kC>
class IntervalEntries {
 public:
  IntervalEntries() = default;

  // structure: members f, cost and rows, Pattern<kX + kU> each: what a stage gives depends on which of its inputs.
  // curved: the pairs of inputs by which something of it has second derivatives, the larger one first.
  template <class Structure>
  IntervalEntries(const Scheme& scheme, const Structure& structure, const std::vector<std::pair<int, int>>& curved)
      : rows(index(scheme.stages() * kC)),
        pairs(index(scheme.stages())),
        with_duration(index(scheme.stages())),
        scheme_(scheme),
        first_new_(scheme.starts_at_node ? 1 : 0) {
    for (int i = first_new_; i < scheme.stages(); ++i) {
      for (int r = 0; r < kX; ++r) list_defect(i, r, structure.f[index(r)]);
    }
    for (int j = 0; j < scheme.stages(); ++j) {
      for (int c = 0; c < kC; ++c) {
        for (int i = 0; i < kV; ++i) {
          if (structure.rows[index(c)].depends_on(i)) list_input(rows[index(j * kC + c)], j, i);
        }
      }
      for (const auto& [a, b] : curved) list_pair(j, a, b);
      for (int i = 0; i < kV; ++i) {
        bool present = structure.cost.depends_on(i);
        for (const auto& f : structure.f) present = present || f.depends_on(i);
        if (present) list_input(with_duration[index(j)], j, i);
      }
    }
  }

  std::vector<DefectEntry> defects;
  std::vector<std::vector<InputEntry>> rows;           // of row c at stage j: j kC + c
  std::vector<std::vector<PairEntry>> pairs;           // of stage j
  std::vector<std::vector<InputEntry>> with_duration;  // second derivatives by it and an input of stage j

 private:
  static constexpr int kV = kX + kU;
  static constexpr std::size_t index(int i) { return static_cast<std::size_t>(i); }

  // visit(variable, coefficient) for the variables that input i of stage j is made of.
  template <class Visit>
  void spread(int j, int i, Visit&& visit) const {
    if (i >= kX) {
      for (int end = 0; end < 2; ++end) {
        const double coefficient = scheme_.control_fraction(j, end);
        if (coefficient != 0) visit(EntryVariable{EntryVariable::kInterval, end * kU + i - kX}, coefficient);
      }
    } else if (j < first_new_) {
      visit(EntryVariable{EntryVariable::kNode, i}, 1.0);
    } else {
      visit(EntryVariable{EntryVariable::kInterval, 2 * kU + (j - first_new_) * kX + i}, 1.0);
    }
  }

  // Component r, which depends on these inputs, of the defect of stage i.
  void list_defect(int i, int r, const Pattern<kV>& depends) {
    for (int j = 0; j < scheme_.stages(); ++j) {
      for (int c = 0; c < kV; ++c) {
        const bool node_itself = j < first_new_ && c == r, stage_itself = j == i && c == r;
        if (!depends.depends_on(c) && !node_itself && !stage_itself) continue;
        const double own = node_itself ? -1 : stage_itself ? 1 : 0;
        spread(j, c, [&](const EntryVariable& of, double coefficient) {
          defects.push_back({i, r, j, c, coefficient * own, coefficient * scheme_.A(i, j), of});
        });
      }
    }
    if (first_new_ == 0) defects.push_back({i, r, 0, r, -1, 0, {EntryVariable::kNode, r}});
    defects.push_back({i, r, 0, 0, 0, 0, {EntryVariable::kDuration, 0}});
  }

  void list_input(std::vector<InputEntry>& to, int j, int i) const {
    spread(j, i, [&](const EntryVariable& of, double coefficient) { to.push_back({i, coefficient, of}); });
  }

  // A pair (a, a) spread over u_begin and u_end has two equal off-diagonal entries: the lower triangle holds one.
  void list_pair(int j, int a, int b) {
    const std::size_t packed = Dual2<kV>::row(index(a)) + index(b);
    spread(j, a, [&](const EntryVariable& of, double coefficient) {
      spread(j, b, [&](const EntryVariable& with, double other_coefficient) {
        if (a == b && with.at > of.at) return;
        pairs[index(j)].push_back({packed, coefficient * other_coefficient, of, with});
      });
    });
  }

  Scheme scheme_;
  int first_new_ = 0;
};

}  // namespace fjr
