// Records a function that is templated on its scalar as a list of operations, which can then be evaluated on power
// series, coefficient by coefficient.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <map>
#include <tuple>
#include <vector>

#include "common/enclosure/ball.h"

namespace enclosure {

enum class Op {
  kInput,
  kConstant,
  kAdd,
  kSubtract,
  kScale,
  kShift,
  kMultiply,
  kDivide,
  kSine,
  kCosine,
  kTanh,
  kTanhRate,
  kSech2,
  kExp
};

// An operation on the earlier nodes a and b and a constant. Some nodes are computed together: kSine at i and kCosine at
// i + 1; and t = tanh a (kTanh) at i, t a' (kTanhRate) at i + 1, w = 1 - t^2 (kSech2) at i + 2.
struct Node {
  Op op;
  std::size_t a = 0, b = 0;
  Ball constant{};
};

class Recording;

// A number while a function is recorded: a node, or a constant that has not been recorded.
class Active {
 public:
  Active() = default;
  Active(double value) : constant_(value) {}  // NOLINT(google-explicit-constructor): constants mix with active numbers
  Active(Recording& in, std::size_t node) : in_(&in), node_(node) {}

  bool is_constant() const { return in_ == nullptr; }
  const Ball& constant() const { return constant_; }
  std::size_t node() const { return node_; }
  Recording& in() const { return *in_; }

 private:
  friend Active constant(const Ball& value);
  Recording* in_ = nullptr;
  std::size_t node_ = 0;
  Ball constant_{};
};

inline Active constant(const Ball& value) {
  Active a;
  a.constant_ = value;
  return a;
}

class Recording {
 public:
  explicit Recording(std::size_t inputs) : inputs_(inputs) {
    for (std::size_t i = 0; i < inputs; ++i) nodes_.push_back({Op::kInput, i});
  }
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;
  Recording(Recording&&) = default;  // when it is complete: active numbers keep pointing to where it was made

  Active input(std::size_t i) { return {*this, i}; }
  std::size_t inputs() const { return inputs_; }
  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<std::size_t>& outputs() const { return outputs_; }

  void output(const Active& value) { outputs_.push_back(node_of(value)); }

  // Returns the function with this output only, which keeps the nodes it needs and all inputs.
  Recording only(std::size_t output) const {
    std::vector<char> needed(nodes_.size(), 0);
    needed[outputs_[output]] = 1;
    for (std::size_t i = nodes_.size(); i-- > inputs_;) {
      if (needed[i]) needed[first_of_group(i)] = 1;
      if (needed[i]) needed[nodes_[i].a] = needed[nodes_[i].b] = 1;
    }
    Recording r(inputs_);
    std::vector<std::size_t> moved(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      moved[i] = i < inputs_ ? i : r.nodes_.size();
      const Node& n = nodes_[i];
      if (i >= inputs_ && needed[first_of_group(i)]) r.nodes_.push_back({n.op, moved[n.a], moved[n.b], n.constant});
    }
    r.outputs_.push_back(moved[outputs_[output]]);
    return r;
  }

  // Returns the function with the input and the output of this number replaced by two additional inputs, in this order:
  // a state of x' = f(x) and its rate are then given from outside.
  Recording with_given(std::size_t number) const {
    constexpr std::size_t kGiven = 2;
    Recording r(inputs_ + kGiven);
    const auto moved = [&](std::size_t node) {
      if (node == number) return inputs_;
      return node < inputs_ ? node : node + kGiven;
    };
    for (std::size_t i = inputs_; i < nodes_.size(); ++i) {
      const Node& n = nodes_[i];
      r.nodes_.push_back({n.op, moved(n.a), moved(n.b), n.constant});
    }
    for (const std::size_t node : outputs_) r.outputs_.push_back(moved(node));
    r.outputs_[number] = inputs_ + 1;
    return r;
  }

  // Returns the node of this operation, an existing one if it was recorded before.
  Active add(Op op, std::size_t a, std::size_t b = 0, const Ball& c = {}) {
    const auto [at, is_new] = known_.try_emplace({op, a, b, c.mid, c.rad}, nodes_.size());
    if (is_new) nodes_.push_back({op, a, b, c});
    return {*this, at->second};
  }
  // Adds nodes that are computed together, and returns the first.
  std::size_t add_group(std::initializer_list<Op> ops, std::size_t a) {
    const auto [at, is_new] = known_.try_emplace({*ops.begin(), a, 0, 0, 0}, nodes_.size());
    for (const Op op : ops) {
      if (is_new) nodes_.push_back({op, a});
    }
    return at->second;
  }
  std::size_t node_of(const Active& value) {
    return value.is_constant() ? add(Op::kConstant, 0, 0, value.constant()).node() : value.node();
  }

 private:
  // Returns the first of the nodes that are computed together with node i and refer to each other by their positions.
  std::size_t first_of_group(std::size_t i) const {
    switch (nodes_[i].op) {
      case Op::kCosine:
      case Op::kTanhRate:
        return i - 1;
      case Op::kSech2:
        return i - 2;
      default:
        return i;
    }
  }

  std::size_t inputs_;
  std::vector<Node> nodes_;
  std::vector<std::size_t> outputs_;
  std::map<std::tuple<Op, std::size_t, std::size_t, double, double>, std::size_t> known_;
};

inline Active operator-(const Active& a) {
  return a.is_constant() ? constant(-a.constant()) : a.in().add(Op::kScale, a.node(), 0, -1.0);
}
inline Active operator+(const Active& a, const Active& b) {
  if (a.is_constant() && b.is_constant()) return constant(a.constant() + b.constant());
  if (b.is_constant()) return a.in().add(Op::kShift, a.node(), 0, b.constant());
  if (a.is_constant()) return b + a;
  return a.in().add(Op::kAdd, a.node(), b.node());
}
inline Active operator-(const Active& a, const Active& b) {
  if (a.is_constant() || b.is_constant()) return a + -b;
  return a.in().add(Op::kSubtract, a.node(), b.node());
}
inline Active operator*(const Active& a, const Active& b) {
  if (a.is_constant() && b.is_constant()) return constant(a.constant() * b.constant());
  if (b.is_constant()) return a.in().add(Op::kScale, a.node(), 0, b.constant());
  if (a.is_constant()) return b * a;
  return a.in().add(Op::kMultiply, a.node(), b.node());
}
inline Active operator/(const Active& a, const Active& b) {
  if (b.is_constant()) return a * constant(Ball(1) / b.constant());
  return b.in().add(Op::kDivide, b.in().node_of(a), b.node());
}
inline Active& operator+=(Active& a, const Active& b) { return a = a + b; }
inline Active& operator-=(Active& a, const Active& b) { return a = a - b; }
inline Active& operator*=(Active& a, const Active& b) { return a = a * b; }
inline Active sin(const Active& a) {
  return a.is_constant() ? constant(sin(a.constant()))
                         : Active(a.in(), a.in().add_group({Op::kSine, Op::kCosine}, a.node()));
}
inline Active cos(const Active& a) {
  return a.is_constant() ? constant(cos(a.constant()))
                         : Active(a.in(), a.in().add_group({Op::kSine, Op::kCosine}, a.node()) + 1);
}
inline Active tanh(const Active& a) {
  return a.is_constant() ? constant(tanh(a.constant()))
                         : Active(a.in(), a.in().add_group({Op::kTanh, Op::kTanhRate, Op::kSech2}, a.node()));
}
inline Active exp(const Active& a) {
  return a.is_constant() ? constant(exp(a.constant())) : a.in().add(Op::kExp, a.node());
}

}  // namespace enclosure
