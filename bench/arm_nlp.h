// The arm's NLP on a uniform mesh, and its KKT matrix: what the benchmarks of the layers work on.
#pragma once

#include <random>
#include <vector>

#include "planner/collocation/transcription.h"
#include "planner/nlp/chain/chain_ldlt.h"
#include "planner/ocp/arm_ocp.h"

namespace fjr::bench {

using ArmTranscription = Transcription<ArmOcp<Features{}>>;

// Minimum time with a regularisation by effort and the default limits, Hermite-Simpson.
inline ArmTranscription arm_nlp(const Parameters& robot, int intervals) {
  Problem problem;
  problem.robot = robot;
  problem.limits = Limits::of(robot);
  problem.weights.time = 1;
  auto ocp = make_arm_ocp<Features{}>(problem, 0.01);
  ocp.bounds = {path_bounds<Features{}>(problem.limits)};
  NodeBounds<8> start{0, {}, {}};
  start.lower = start.upper = filled<8>(0);
  ocp.at_nodes = {start};
  ocp.durations = {{0.1, 5}};
  Mesh mesh;
  for (int i = 0; i < intervals; ++i) mesh.intervals.push_back({1.0 / intervals, 0});
  return {std::move(ocp), hermite_simpson(), mesh};
}

inline Eigen::VectorXd random_vector(Eigen::Index size, double scale, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-scale, scale);
  return Eigen::VectorXd::NullaryExpr(size, [&] { return uniform(generator); });
}

// A point inside the bounds.
inline Eigen::VectorXd some_point(const ArmTranscription& nlp) {
  Eigen::VectorXd z = random_vector(nlp.variables(), 0.3, 1);
  z(nlp.duration_at(0)) = 0.5;
  return z;
}

// The KKT matrix in Ipopt's order - free variables, slacks, equality rows, inequality rows - as triplets of its lower
// triangle, with what every row is.
struct Kkt {
  int size = 0;
  ChainStructure structure;
  std::vector<int> rows, cols;
  std::vector<double> values;
};

inline Kkt kkt_of(const Nlp& nlp, const Eigen::VectorXd& z) {
  Kkt kkt;
  kkt.structure.blocks = nlp.blocks;
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  std::vector<int> variable(at(static_cast<int>(nlp.variables())), -1), row(at(static_cast<int>(nlp.constraints())));
  for (int i = 0; i < nlp.variables(); ++i) {
    if (nlp.x_lower(i) == nlp.x_upper(i)) continue;
    variable[at(i)] = kkt.size++;
    kkt.structure.block.push_back(nlp.variable_block[at(i)]);
  }
  kkt.structure.equality.assign(at(kkt.size), false);
  const auto inequality = [&](int i) { return nlp.g_lower(i) != nlp.g_upper(i); };
  std::vector<int> slack(row.size(), -1);
  for (const int part : {0, 1, 2}) {
    for (int i = 0; i < nlp.constraints(); ++i) {
      if (inequality(i) != (part != 1)) continue;
      (part == 0 ? slack : row)[at(i)] = kkt.size++;
      kkt.structure.equality.resize(at(kkt.size), part == 1);
      kkt.structure.block.push_back(nlp.constraint_block[at(i)]);
    }
  }
  const auto add = [&](int i, int j, double value) {
    kkt.rows.push_back(std::max(i, j));
    kkt.cols.push_back(std::min(i, j));
    kkt.values.push_back(value);
  };
  Eigen::VectorXd hessian(nlp.hessian_pattern.size()), jacobian(nlp.jacobian_pattern.size());
  nlp.hessian(z, 1, random_vector(nlp.constraints(), 1e-3, 2), hessian);
  nlp.jacobian(z, jacobian);
  for (Eigen::Index e = 0; e < hessian.size(); ++e) {
    const auto& entry = nlp.hessian_pattern[static_cast<std::size_t>(e)];
    const int i = variable[at(entry.row)], j = variable[at(entry.col)];
    if (i >= 0 && j >= 0) add(i, j, hessian(e));
  }
  // Barrier terms: some of the bounds close, most far.
  const Eigen::VectorXd closeness = random_vector(kkt.size, 3, 3);
  for (int i = 0; i < nlp.variables(); ++i) {
    if (variable[at(i)] >= 0) add(variable[at(i)], variable[at(i)], std::pow(10, closeness(variable[at(i)])));
  }
  for (Eigen::Index e = 0; e < jacobian.size(); ++e) {
    const auto& entry = nlp.jacobian_pattern[static_cast<std::size_t>(e)];
    if (variable[at(entry.col)] >= 0) add(row[at(entry.row)], variable[at(entry.col)], jacobian(e));
  }
  for (int i = 0; i < nlp.constraints(); ++i) {
    add(row[at(i)], row[at(i)], 0);
    if (slack[at(i)] < 0) continue;
    add(slack[at(i)], slack[at(i)], std::pow(10, closeness(slack[at(i)])));
    add(row[at(i)], slack[at(i)], -1);
  }
  return kkt;
}

}  // namespace fjr::bench
