// The transcription's derivatives against central differences, its defects against loops written from the tables alone,
// and its bounds at the variables they are meant for: for every scheme and three plants.
#include "planner/collocation/transcription.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <ostream>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "planner/ocp/arm_ocp.h"
#include "planner/problem/task/task.h"
#include "tests/support/plants.h"

namespace fjr {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double uniform(std::mt19937_64& random, double low, double high) {  // the same on every library
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

Mesh mesh_of_segments(int segments) {
  if (segments == 1) return {{{0.3, 0}, {0.5, 0}, {0.2, 0}}};
  return {{{0.6, 0}, {0.4, 0}, {0.25, 1}, {0.75, 1}}};
}

// ---- the plants, every term of theirs switched on ----

template <Features F>
ArmOcp<F> arm(double friction_width, int segments) {
  Problem problem;
  problem.robot = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  problem.robot.link.damping = {0.2516, 0.013};
  problem.robot.payload = {0.3, 0.001};
  Limits& limits = problem.limits;
  limits.torque = {12, 5};
  limits.motor_velocity = {6, 8};
  limits.link_position = {3.2, 2.6};
  limits.spring_deflection = {0.3864, 0.2262};
  limits.torque_rate = {300, 200};
  limits.tip_speed = 3;
  limits.motor_power = {60, 30};
  problem.weights = {.time = 1.3,
                     .effort = 0.7,
                     .torque_rate = 2e-4,
                     .link_acceleration = 1e-3,
                     .link_jerk = 1e-6,
                     .energy = 0.2,
                     .copper = 0.3,
                     .peak_torque = F.peak ? 0.4 : 0,
                     .tip_speed = 0.9};
  auto ocp = make_arm_ocp<F>(problem, 0.001);
  ocp.regularisation = 0.05;
  ocp.kink = 10 * friction_width;
  ocp.cost_nodes = {{2, Node::kRelease}, {mesh_of_segments(segments).size(), Node::kGoal}};
  for (FrictionLaw& law : ocp.friction) law = law.smoothed(friction_width);
  ocp.bounds = {path_bounds<F>(limits)};
  if constexpr (F.peak) bound_peaks<F>(ocp.bounds[0], problem, {0, 0});
  if constexpr (F.task_rows > 0) {  // a row of every kind, and lines that differ from segment to segment
    Task task;
    task.obstacles.discs = {{{0.3, -0.2}, 0.05, 0.01}};
    task.obstacles.walls = {{{0.4, 0}, {-1, 0.5}, 0.01}};
    task.box = TipBox{{-0.5, -0.6}, {0.5, 0.2}};
    task.arc = TipArc{{0, 0.1}, {0, -0.5}, {0.6, 0.1}, 0.01};
    task.path = JointPath{{{0, 0}, {0.5, 1}, {1.2, 0.3}}, 0.01};
    for (int s = 0; s < segments; ++s) ocp.tasks.push_back(task_rows(problem.robot, task, static_cast<std::size_t>(s)));
    for (std::size_t r = 0; r < ocp.tasks[0].size(); ++r) {
      ocp.bounds[0].row_lower[ArmOcp<F>::kTask + r] = ocp.tasks[0][r].lower;
      ocp.bounds[0].row_upper[ArmOcp<F>::kTask + r] = ocp.tasks[0][r].upper;
    }
  }
  return ocp;
}

VanDerPol van_der_pol() {
  VanDerPol ocp;
  ocp.time_weight = 0.9;
  ocp.bounds[0].row_lower = {-1, -0.25, -kInfinity};
  ocp.bounds[0].row_upper = {2, kInfinity, kInfinity};
  return ocp;
}

// ---- one case: a transcription and points to look at it ----

struct Case {
  std::string plant;
  Scheme scheme;
  int segments;
  double width;  // [rad/s or 1] over which the problem's functions bend
  std::function<std::unique_ptr<Nlp>(const Case&)> make;

  std::string name() const {
    return identifier(plant + "_" + scheme.name + "_" + std::to_string(segments) +
                      (segments == 1 ? "_segment" : "_segments"));
  }
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name(); }

template <class Ocp>
std::unique_ptr<Nlp> transcribe(Ocp ocp, const Case& c) {
  ocp.durations.assign(static_cast<std::size_t>(c.segments), {0.02, 20});
  if (c.segments > 1) ocp.duration_sums = {{0, c.segments - 1, 0.05, 20}};
  return std::make_unique<Transcription<Ocp>>(std::move(ocp), c.scheme, mesh_of_segments(c.segments));
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const Scheme& scheme : all_schemes()) {
    for (const int segments : {1, 2}) {
      for (const double width : {0.1, 0.01}) {
        const std::string suffix = width == 0.1 ? "_wide" : "_narrow";
        all.push_back({"arm" + suffix, scheme, segments, width,
                       [](const Case& c) { return transcribe(arm<Features{}>(c.width, c.segments), c); }});
        all.push_back({"rate_arm" + suffix, scheme, segments, width,
                       [](const Case& c) { return transcribe(arm<Features{.rate = true}>(c.width, c.segments), c); }});
      }
      all.push_back({"task_arm", scheme, segments, 0.1,
                     [](const Case& c) { return transcribe(arm<Features{.task_rows = 11}>(c.width, c.segments), c); }});
      all.push_back({"peak_arm", scheme, segments, 0.1, [](const Case& c) {
                       return transcribe(
                           arm<Features{.rate = true, .task_rows = 11, .peak = true}>(c.width, c.segments), c);
                     }});
      all.push_back({"van_der_pol", scheme, segments, 1, [](const Case& c) { return transcribe(van_der_pol(), c); }});
    }
  }
  return all;
}

// States and controls of order one, many of them within the width of the friction law; durations of order one.
VectorXd random_point(const Nlp& nlp, int segments, double width, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  VectorXd z(nlp.variables());
  for (double& value : z) value = uniform(random, 0, 1) < 0.5 ? uniform(random, -1, 1) : width * uniform(random, -2, 2);
  for (int s = 0; s < segments; ++s) z(z.size() - 1 - s) = uniform(random, 0.3, 1.1);
  return z;
}

VectorXd random_multipliers(const Nlp& nlp, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  VectorXd lambda(nlp.constraints());
  for (double& value : lambda) value = uniform(random, -1, 1);
  return lambda;
}

// ---- dense forms ----

MatrixXd dense_jacobian(const Nlp& nlp, const VectorXd& z) {
  VectorXd values = VectorXd::Constant(static_cast<Eigen::Index>(nlp.jacobian_pattern.size()), NAN);
  nlp.jacobian(z, values);
  MatrixXd dense = MatrixXd::Zero(nlp.constraints(), nlp.variables());
  for (std::size_t e = 0; e < nlp.jacobian_pattern.size(); ++e) {
    dense(nlp.jacobian_pattern[e].row, nlp.jacobian_pattern[e].col) += values(static_cast<Eigen::Index>(e));
  }
  return dense;
}

MatrixXd dense_hessian(const Nlp& nlp, const VectorXd& z, double cost_factor, const VectorXd& lambda) {
  VectorXd values = VectorXd::Constant(static_cast<Eigen::Index>(nlp.hessian_pattern.size()), NAN);
  nlp.hessian(z, cost_factor, lambda, values);
  MatrixXd dense = MatrixXd::Zero(nlp.variables(), nlp.variables());
  for (std::size_t e = 0; e < nlp.hessian_pattern.size(); ++e) {
    const auto [row, col] = nlp.hessian_pattern[e];
    dense(row, col) += values(static_cast<Eigen::Index>(e));
    if (row != col) dense(col, row) += values(static_cast<Eigen::Index>(e));
  }
  return dense;
}

VectorXd gradient(const Nlp& nlp, const VectorXd& z) {
  VectorXd out = VectorXd::Constant(z.size(), NAN);
  nlp.gradient(z, out);
  return out;
}

VectorXd constraints(const Nlp& nlp, const VectorXd& z) {
  VectorXd out = VectorXd::Constant(nlp.constraints(), NAN);
  nlp.constraint_values(z, out);
  return out;
}

// ---- differences ----

// Central differences of F, a function that bends over `width`, with the step h = eps^(1/3) width. Truncation,
// h^2/6 |F'''| with |F'''| <= 24 |F| / width^3 (fourth derivatives of tanh), and rounding, eps |F| / h, are both at
// most 4 eps^(2/3) |F| / width; a sum of some dozen terms may lose a digit more.
struct Differences {
  MatrixXd matrix;
  double tolerance;
};

Differences central(const VectorXd& z, double width, const std::function<VectorXd(const VectorXd&)>& f) {
  const double unit = std::cbrt(std::numeric_limits<double>::epsilon()), h = unit * width;
  const VectorXd here = f(z);
  Differences d{MatrixXd(here.size(), z.size()), 40 * unit * unit * (1 + here.cwiseAbs().maxCoeff()) / width};
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    VectorXd after = z, before = z;
    after(i) += h;
    before(i) -= h;
    d.matrix.col(i) = (f(after) - f(before)) / (after(i) - before(i));
  }
  return d;
}

testing::AssertionResult agree(const MatrixXd& exact, const Differences& differences) {
  Eigen::Index row = 0, col = 0;
  const double worst = (exact - differences.matrix).cwiseAbs().maxCoeff(&row, &col);
  if (worst <= differences.tolerance) return testing::AssertionSuccess();  // and NaN fails
  return testing::AssertionFailure() << "entry (" << row << ", " << col << ") is " << exact(row, col)
                                     << ", differences give " << differences.matrix(row, col) << ", tolerance "
                                     << differences.tolerance;
}

Differences jacobian_differences(const Nlp& nlp, const VectorXd& z, double width) {
  return central(z, width, [&](const VectorXd& at) { return constraints(nlp, at); });
}
Differences gradient_differences(const Nlp& nlp, const VectorXd& z, double width) {
  return central(z, width, [&](const VectorXd& at) { return VectorXd::Constant(1, nlp.objective(at)); });
}
Differences hessian_differences(const Nlp& nlp, const VectorXd& z, double width, double cost_factor,
                                const VectorXd& lambda) {
  return central(z, width, [&](const VectorXd& at) -> VectorXd {
    return cost_factor * gradient(nlp, at) + dense_jacobian(nlp, at).transpose() * lambda;
  });
}

class Derivatives : public testing::TestWithParam<Case> {
 protected:
  std::unique_ptr<Nlp> nlp = GetParam().make(GetParam());
  double width = GetParam().width;
  VectorXd point(std::uint64_t seed) const { return random_point(*nlp, GetParam().segments, width, seed); }
};

constexpr double kCostFactor = 0.7;

TEST_P(Derivatives, JacobianMatchesDifferences) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    EXPECT_TRUE(agree(dense_jacobian(*nlp, point(seed)), jacobian_differences(*nlp, point(seed), width)));
  }
}

TEST_P(Derivatives, GradientMatchesDifferences) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    EXPECT_TRUE(agree(gradient(*nlp, point(seed)).transpose(), gradient_differences(*nlp, point(seed), width)));
  }
}

TEST_P(Derivatives, HessianMatchesDifferences) {
  for (const std::uint64_t seed : {1, 2}) {
    const VectorXd z = point(seed), lambda = random_multipliers(*nlp, seed + 10);
    EXPECT_TRUE(
        agree(dense_hessian(*nlp, z, kCostFactor, lambda), hessian_differences(*nlp, z, width, kCostFactor, lambda)));
  }
}

// The checker itself: one entry off by 1e-4 of the largest.
TEST_P(Derivatives, AWrongEntryIsCaught) {
  const VectorXd z = point(4), lambda = random_multipliers(*nlp, 14);
  MatrixXd jacobian = dense_jacobian(*nlp, z);
  jacobian(1, 2) += 1e-4 * jacobian.cwiseAbs().maxCoeff();
  EXPECT_FALSE(agree(jacobian, jacobian_differences(*nlp, z, width)));
  VectorXd slope = gradient(*nlp, z);
  slope(3) += 1e-4 * slope.cwiseAbs().maxCoeff();
  EXPECT_FALSE(agree(slope.transpose(), gradient_differences(*nlp, z, width)));
  MatrixXd hessian = dense_hessian(*nlp, z, kCostFactor, lambda);
  hessian(4, 2) += 1e-4 * hessian.cwiseAbs().maxCoeff();
  EXPECT_FALSE(agree(hessian, hessian_differences(*nlp, z, width, kCostFactor, lambda)));
}

TEST_P(Derivatives, PatternsStayInsideTheirMatrix) {
  for (const auto& [row, col] : nlp->jacobian_pattern) {
    EXPECT_TRUE(row >= 0 && row < nlp->constraints() && col >= 0 && col < nlp->variables());
  }
  for (const auto& [row, col] : nlp->hessian_pattern) {
    EXPECT_TRUE(col >= 0 && col <= row && row < nlp->variables()) << row << ", " << col;
  }
}

TEST_P(Derivatives, EvaluationGivesTheSameBitsTwice) {
  const VectorXd z = point(5), lambda = random_multipliers(*nlp, 15);
  EXPECT_EQ(nlp->objective(z), nlp->objective(z));
  EXPECT_EQ(constraints(*nlp, z), constraints(*nlp, z));
  EXPECT_EQ(dense_hessian(*nlp, z, 1, lambda), dense_hessian(*nlp, z, 1, lambda));
}

TEST_P(Derivatives, HalvesOnTwoThreadsGiveTheSameBits) {
  const VectorXd z = point(1), lambda = random_multipliers(*nlp, 2);
  const std::unique_ptr<Nlp> halved = GetParam().make(GetParam());
  int pairs = 0;
  halved->both = [&](const auto& one, const auto& other) {
    ++pairs;
    const std::jthread second(other);
    one();
  };
  EXPECT_EQ(halved->objective(z), nlp->objective(z));
  EXPECT_EQ(constraints(*halved, z), constraints(*nlp, z));
  EXPECT_EQ(gradient(*halved, z), gradient(*nlp, z));
  EXPECT_EQ(dense_jacobian(*halved, z), dense_jacobian(*nlp, z));
  EXPECT_EQ(dense_hessian(*halved, z, kCostFactor, lambda), dense_hessian(*nlp, z, kCostFactor, lambda));
  EXPECT_GE(pairs, 5);
}

// What an instance keeps of one point is not in what it gives at the next.
TEST_P(Derivatives, EvaluationForgetsOtherPoints) {
  const VectorXd z = point(6), other = point(7), lambda = random_multipliers(*nlp, 16);
  constraints(*nlp, other);
  dense_hessian(*nlp, other, 1, lambda);
  const std::unique_ptr<Nlp> fresh = GetParam().make(GetParam());
  EXPECT_EQ(nlp->objective(z), fresh->objective(z));
  EXPECT_EQ(constraints(*nlp, z), constraints(*fresh, z));
  EXPECT_EQ(gradient(*nlp, z), gradient(*fresh, z));
  EXPECT_EQ(dense_jacobian(*nlp, z), dense_jacobian(*fresh, z));
  EXPECT_EQ(dense_hessian(*nlp, z, 1, lambda), dense_hessian(*fresh, z, 1, lambda));
}

INSTANTIATE_TEST_SUITE_P(Transcription, Derivatives, testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name(); });

// ---- values, from the description in the header alone ----

// Walks the vector of variables in the stated order: x_0, then per interval u_begin, u_end and the stages, then the
// durations.
template <class Ocp>
struct Naive {
  static constexpr Eigen::Index kX = Ocp::kStates, kU = Ocp::kControls;
  Ocp ocp;
  Scheme scheme;
  Mesh mesh;
  double objective = 0;
  std::vector<double> defects, rows;

  void evaluate(const VectorXd& z) {
    const Eigen::Index segments = mesh.segments();
    const auto durations = z.tail(segments);
    Eigen::Index cursor = 0;
    const auto take = [&](Eigen::Index count) {
      cursor += count;
      return VectorXd(z.segment(cursor - count, count));
    };
    VectorXd node = take(kX);
    std::size_t passed = 0;
    objective = ocp.time_weight * durations.sum();
    for (const Mesh::Interval& interval : mesh.intervals) {
      const double h = interval.fraction * durations(interval.segment);
      const VectorXd begin = take(kU), end = take(kU);
      std::vector<VectorXd> y, f;
      for (int j = 0; j < scheme.stages(); ++j) y.push_back(scheme.points(j) == 0 ? node : take(kX));
      for (int j = 0; j < scheme.stages(); ++j) {
        const VectorXd u = begin + scheme.points(j) * (end - begin);
        VectorXd rate(kX), row(Ocp::kRows);
        double cost = 0;
        const double* state = y[static_cast<std::size_t>(j)].data();
        if constexpr (requires { ocp.evaluate(0, state, state, rate.data(), cost, row.data()); }) {
          ocp.evaluate(interval.segment, state, u.data(), rate.data(), cost, row.data());
        } else {
          ocp.template evaluate<double>(state, u.data(), rate.data(), cost, row.data());
        }
        f.push_back(rate);
        objective += h * scheme.b(j) * cost;
        for (int c = 0; c < Ocp::kRows; ++c) {
          const auto i = static_cast<std::size_t>(c);
          const bool bounded = std::isfinite(ocp.bounds[0].row_lower[i]) || std::isfinite(ocp.bounds[0].row_upper[i]);
          if (bounded && (Ocp::kRowUsesControl[i] || scheme.points(j) > 0)) rows.push_back(row(c));
        }
      }
      for (int i = 0; i < scheme.stages(); ++i) {
        if (scheme.points(i) == 0) continue;
        VectorXd defect = y[static_cast<std::size_t>(i)] - node;
        for (int j = 0; j < scheme.stages(); ++j) defect -= h * scheme.A(i, j) * f[static_cast<std::size_t>(j)];
        defects.insert(defects.end(), defect.begin(), defect.end());
      }
      node = y.back();
      ++passed;
      if constexpr (requires { ocp.cost_nodes; }) {
        for (const auto& at : ocp.cost_nodes) {
          if (at.node == passed) objective += ocp.node_cost(at, node.data());
        }
      }
    }
    if (segments > 1) rows.push_back(durations.sum());
    EXPECT_EQ(cursor + segments, z.size());
  }
};

template <class Ocp>
void expect_naive_values(Ocp ocp, const Scheme& scheme, int segments) {
  const Mesh mesh = mesh_of_segments(segments);
  ocp.durations.assign(static_cast<std::size_t>(segments), {0.02, 20});
  if (segments > 1) ocp.duration_sums = {{0, segments - 1, 0.05, 20}};
  const Transcription<Ocp> nlp(ocp, scheme, mesh);
  const VectorXd z = random_point(nlp, segments, 0.1, 6);
  Naive<Ocp> naive{ocp, scheme, mesh, 0, {}, {}};
  naive.evaluate(z);
  // Sums of the same terms in another order: a few roundings of accelerations of order 1e3.
  EXPECT_NEAR(nlp.objective(z), naive.objective, 1e-12 * (1 + std::abs(naive.objective)));
  std::vector<double> expected = naive.defects;
  expected.insert(expected.end(), naive.rows.begin(), naive.rows.end());
  const VectorXd g = constraints(nlp, z);
  std::vector<double> values(g.begin(), g.end());
  ASSERT_EQ(values.size(), expected.size());
  std::sort(values.begin(), values.end());
  std::sort(expected.begin(), expected.end());
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(values[i], expected[i], 1e-11) << i;
  // And the defects where defect_row() says they are.
  std::size_t next = 0;
  for (int k = 0; k < nlp.intervals(); ++k) {
    for (int i = scheme.starts_at_node ? 1 : 0; i < scheme.stages(); ++i) {
      for (int r = 0; r < Ocp::kStates; ++r) EXPECT_NEAR(g(nlp.defect_row(k, i, r)), naive.defects[next++], 1e-11);
    }
  }
}

class Values : public testing::TestWithParam<Scheme> {};

TEST_P(Values, AgreeWithLoopsWrittenFromTheTables) {
  for (const int segments : {1, 2}) {
    expect_naive_values(van_der_pol(), GetParam(), segments);
    expect_naive_values(arm<Features{}>(0.05, segments), GetParam(), segments);
    expect_naive_values(arm<Features{.rate = true}>(0.05, segments), GetParam(), segments);
    expect_naive_values(arm<Features{.task_rows = 11}>(0.05, segments), GetParam(), segments);
    expect_naive_values(arm<Features{.task_rows = 11, .peak = true}>(0.05, segments), GetParam(), segments);
  }
}

// The polynomial takes the stages' values less their defects, so it passes through them where the defects vanish.
TEST_P(Values, StatePolynomialPassesThroughTheStages) {
  const Scheme& scheme = GetParam();
  VanDerPol ocp = van_der_pol();
  ocp.durations = {{0.02, 20}};
  const Transcription<VanDerPol> nlp(ocp, scheme, mesh_of_segments(1));
  const VectorXd z = random_point(nlp, 1, 1, 7), g = constraints(nlp, z);
  for (int k = 0; k < nlp.intervals(); ++k) {
    const auto y = nlp.state_polynomial(z, k);
    const auto u = nlp.control_polynomial(z, k);
    for (int j = 0; j < scheme.stages(); ++j) {
      for (int r = 0; r < 2; ++r) {
        double value = 0;
        for (Eigen::Index d = 0; d < y.cols(); ++d) value += y(r, d) * std::pow(scheme.points(j), d);
        const double defect = nlp.x_at(k, j) == nlp.node_at(k) ? 0 : g(nlp.defect_row(k, j, r));
        EXPECT_NEAR(value, z(nlp.x_at(k, j) + r) - defect, 1e-13);
      }
    }
    EXPECT_EQ(u(0, 0), z(nlp.u_at(k, 0)));
    EXPECT_DOUBLE_EQ(u(0, 0) + u(0, 1), z(nlp.u_at(k, 1)));
  }
}

// ---- bounds ----

TEST_P(Values, BoundsLandAtTheirVariables) {
  const Scheme& scheme = GetParam();
  VanDerPol ocp;
  PathBounds<2, 1, 3> loose, tight;
  loose.x_lower = {-5, -kInfinity};
  loose.x_upper = {5, 6};
  loose.u_lower = {-3};
  loose.u_upper = {4};
  loose.row_lower = {-7, -kInfinity, -kInfinity};
  loose.row_upper = {8, 9, kInfinity};
  tight = loose;
  tight.x_upper = {1, 2};
  tight.u_upper = {0.5};
  tight.row_upper = {0.25, kInfinity, kInfinity};
  ocp.bounds = {loose, tight, loose, loose};
  ocp.at_nodes = {{0, {-7, 7}, {-7, 7}}, {3, {-1, -kInfinity}, {kInfinity, 1.5}}};  // 7 is beyond the general bounds
  ocp.durations = {{0.1, 2}, {0.2, 3}};
  ocp.duration_sums = {{0, 1, 0.5, 4}};
  const Transcription<VanDerPol> nlp(ocp, scheme, mesh_of_segments(2));

  const auto expect = [&](int at, double lower, double upper) {
    EXPECT_EQ(nlp.x_lower(at), lower) << at;
    EXPECT_EQ(nlp.x_upper(at), upper) << at;
  };
  expect(nlp.node_at(0), -7, -7);  // given, whatever the general bound
  expect(nlp.node_at(0) + 1, 7, 7);
  expect(nlp.node_at(2), -5, 1);  // the node between intervals 1 and 2: the tighter of both
  expect(nlp.node_at(2) + 1, -kInfinity, 2);
  expect(nlp.node_at(3), -1, 5);  // bounded at the node below, in general above
  expect(nlp.node_at(3) + 1, -kInfinity, 1.5);
  expect(nlp.node_at(4), -5, 5);
  for (int k = 0; k < 4; ++k) {
    for (int end = 0; end < 2; ++end) expect(nlp.u_at(k, end), -3, k == 1 ? 0.5 : 4);
  }
  // With Lobatto points the node before interval 1 is its first stage: the tighter bound holds there, too.
  expect(nlp.node_at(1), -5, scheme.starts_at_node ? 1 : 5);
  for (int j = 0; j + 1 < scheme.stages(); ++j) {  // inside
    if (nlp.x_at(1, j) != nlp.node_at(1)) expect(nlp.x_at(1, j), -5, 1);
    if (nlp.x_at(2, j) != nlp.node_at(2)) expect(nlp.x_at(2, j), -5, 5);
  }
  expect(nlp.duration_at(0), 0.1, 2);
  expect(nlp.duration_at(1), 0.2, 3);
  EXPECT_EQ(nlp.duration_at(1), nlp.variables() - 1);

  std::set<int> rows;
  for (int k = 0; k < 4; ++k) {
    for (int i = scheme.starts_at_node ? 1 : 0; i < scheme.stages(); ++i) {
      for (int r = 0; r < 2; ++r) {
        const int row = nlp.defect_row(k, i, r);
        EXPECT_TRUE(rows.insert(row).second);
        EXPECT_EQ(nlp.g_lower(row), 0);
        EXPECT_EQ(nlp.g_upper(row), 0);
      }
    }
    for (int j = 0; j < scheme.stages(); ++j) {
      const int with_control = nlp.path_row(k, j, 0), with_state = nlp.path_row(k, j, 1);
      ASSERT_GE(with_control, 0);
      EXPECT_TRUE(rows.insert(with_control).second);
      EXPECT_EQ(nlp.g_lower(with_control), -7);
      EXPECT_EQ(nlp.g_upper(with_control), k == 1 ? 0.25 : 8);
      if (k == 1 || (j == 0 && scheme.starts_at_node)) {
        EXPECT_EQ(with_state, -1);  // no bound there, or the node of the interval before
      } else {
        EXPECT_TRUE(rows.insert(with_state).second);
        EXPECT_EQ(nlp.g_lower(with_state), -kInfinity);
        EXPECT_EQ(nlp.g_upper(with_state), 9);
      }
      EXPECT_EQ(nlp.path_row(k, j, 2), -1);  // nobody asks for it
    }
  }
  EXPECT_TRUE(rows.insert(nlp.sum_row(0)).second);
  EXPECT_EQ(nlp.g_lower(nlp.sum_row(0)), 0.5);
  EXPECT_EQ(nlp.g_upper(nlp.sum_row(0)), 4);
  EXPECT_EQ(static_cast<Eigen::Index>(rows.size()), nlp.constraints());  // every row is accounted for
}

INSTANTIATE_TEST_SUITE_P(Transcription, Values, testing::ValuesIn(all_schemes()),
                         [](const auto& test) { return identifier(test.param.name); });

// ---- meshes ----

TEST(Mesh, NodeTimesFollowTheSegmentsDurations) {
  const std::vector<double> times = mesh_of_segments(2).node_times({2, 4});
  const std::vector<double> expected{0, 1.2, 2, 3, 6};
  ASSERT_EQ(times.size(), expected.size());
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_DOUBLE_EQ(times[i], expected[i]);
}

}  // namespace
}  // namespace fjr
