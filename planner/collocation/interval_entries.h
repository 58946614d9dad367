// Lists the entries of the Jacobian and the Hessian that one interval has, and the variables they belong to. The lists
// are the same for every interval and are built once. A transcription writes both the sparsity pattern and the values
// by walking through them in their order.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "common/dual.h"
#include "planner/collocation/scheme.h"

namespace fjr {

struct EntryVariable {  // kNode: state `at` of the node before the interval; kInterval: its variable number `at`
  enum Where { kNode, kInterval, kDuration } where;
  int at;
};
struct DefectEntry {  // its value is own - h factor df/dinput; of the duration: -fraction sum_j A(i,j) f_j
  int defect, row, stage, input;
  double own, factor;  // factor: A(i,j) times d(input)/d(variable)
  EntryVariable of;
};
struct InputEntry {  // its value is coefficient times the derivative by `input`
  int input;
  double coefficient;
  EntryVariable of;
};
struct PairEntry {  // its value is coefficient times the second derivative at index `packed` of the lower triangle
  std::size_t packed;
  double coefficient;
  EntryVariable of, with;
};

// kX, kU and kC are the numbers of states, controls and path constraints. The inputs of a collocation point ("stage" in
// names) are its states, then its controls.
template <int kX, int kU, int kC>
class IntervalEntries {
 public:
  IntervalEntries() = default;

  // `structure` has the members f, cost and rows of type Pattern<kX + kU>, which tell the inputs that each of them
  // depends on. `curved` lists the pairs of inputs for which any of them has a second derivative, the larger index
  // first.
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
  std::vector<std::vector<InputEntry>> rows;           // path constraint c at stage j has index j kC + c
  std::vector<std::vector<PairEntry>> pairs;           // per stage
  std::vector<std::vector<InputEntry>> with_duration;  // per stage: second derivatives by the duration and an input

 private:
  static constexpr int kV = kX + kU;
  static constexpr std::size_t index(int i) { return static_cast<std::size_t>(i); }

  // Calls visit(variable, d(input)/d(variable)) for every variable that input i of stage j depends on.
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

  // Adds the entries of component r of the defect of stage i; `depends` tells the inputs that f_r depends on.
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

  // The second derivative by a control twice (a = b) contributes two equal off-diagonal entries for u_begin and u_end.
  // The lower triangle holds only one of them, so the other is skipped.
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
