// Published optimal control problems (support/published_problems.h): the values of the literature, and the rates at
// which meshes approach them. Hermite-Simpson on equal intervals where nothing else is said.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "planner/nlp/solve.h"
#include "tests/support/published_problems.h"

namespace fjr {
namespace {

SolveReport optimum(const Posed& posed) {
  SolveOptions options;
  options.tolerance = 1e-11;  // so that what is left is the discretisation
  const SolveReport report = solve(*posed.nlp, posed.start, options);
  EXPECT_EQ(report.status, SolveStatus::kOptimal);
  return report;
}

double value(const std::string& name, int intervals) {
  for (const PublishedProblem& problem : published_problems()) {
    if (problem.name == name) return optimum(problem.pose(hermite_simpson(), intervals)).objective;
  }
  throw std::logic_error(name);
}

double reference(const std::string& name) {
  for (const PublishedProblem& problem : published_problems()) {
    if (problem.name == name) return problem.reference;
  }
  throw std::logic_error(name);
}

TEST(PublishedOptima, DoubleIntegrator) {
  // The switch at half time is a node and states are parabolas: only the solver's tolerance is left.
  EXPECT_NEAR(value("double integrator, minimum time", 50), 2, 1e-8);
}

// Bryson & Ho, Applied Optimal Control, section 2.4: tan u falls linearly from tan b to -tan b, so with L = asinh(tan
// b)
//   v = 2 a L / c,  h = a (tan b / cos b - L) / c^2,  T = 2 tan b / c.
double tangent_steering_time(double thrust, double height, double velocity) {
  const auto rate = [&](double b) { return 2 * thrust * std::asinh(std::tan(b)) / velocity; };
  double low = 0.1, high = 1.5;
  while (high - low > 1e-15) {
    const double b = (low + high) / 2;
    const double reached = thrust * (std::tan(b) / std::cos(b) - std::asinh(std::tan(b))) / (rate(b) * rate(b));
    (reached < height ? low : high) = b;
  }
  return 2 * std::tan(low) / rate(low);
}

TEST(PublishedOptima, LinearTangentSteering) {
  const std::string name = "linear tangent steering";
  const double exact = tangent_steering_time(TangentSteering::kThrust, 5, 45);
  EXPECT_NEAR(exact, reference(name), 1e-9);  // one unit of its last digit
  const double coarse = value(name, 20) - exact, fine = value(name, 40) - exact;
  EXPECT_NEAR(fine, 0, 6e-9);         // measured: 4.7e-9
  EXPECT_NEAR(coarse / fine, 16, 2);  // order 4; measured: 16.1
}

// The constraint becomes active and inactive inside of intervals: order 2 whatever the scheme.
TEST(PublishedOptima, RayleighWithMixedConstraint) {
  const std::string name = "Rayleigh, mixed constraint";
  const double coarse = value(name, 100), fine = value(name, 200);
  EXPECT_NEAR((coarse - reference(name)) / (fine - reference(name)), 4, 0.2);  // measured: 3.96
  EXPECT_NEAR((4 * fine - coarse) / 3, reference(name), 2e-5);                 // measured: 1.3e-5
  EXPECT_NEAR(value(name, 400), reference(name), 3e-4);                        // measured: 2.3e-4
}

TEST(PublishedOptima, VanDerPolWithBoundedState) {
  const std::string name = "van der Pol, state bound";
  EXPECT_NEAR(value(name, 25), reference(name), 5e-5);   // measured: 2.7e-5
  EXPECT_NEAR(value(name, 200), reference(name), 5e-6);  // measured: 2.2e-6, which finer meshes keep
}

// ---- the two-link arm ----

// Over `duration` under constant torques, by classical Runge-Kutta.
Eigen::Vector4d after_arc(Eigen::Vector4d x, const Eigen::Vector2d& u, double duration) {
  constexpr int kSteps = 400;
  const auto rate = [&](const Eigen::Vector4d& at) {
    Eigen::Vector4d f;
    double cost;
    TwoLinkArm{}.evaluate<double>(at.data(), u.data(), f.data(), cost, nullptr);
    return f;
  };
  const double h = duration / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const Eigen::Vector4d k1 = rate(x), k2 = rate(x + h / 2 * k1), k3 = rate(x + h / 2 * k2), k4 = rate(x + h * k3);
    x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return x;
}

// How far from the goal the four arcs of full torque lead, of these durations.
Eigen::Vector4d miss(const Eigen::Vector4d& durations) {
  const Eigen::Vector2d torques[] = {{1, 1}, {1, -1}, {-1, -1}, {-1, 1}};
  Eigen::Vector4d x(0, 0, 0.5, 0);
  for (int arc = 0; arc < 4; ++arc) x = after_arc(x, torques[arc], durations[arc]);
  return x - Eigen::Vector4d(0, 0, 0.5, 0.522);
}

// The minimum time: the four switching times are the root of the four conditions at the end, found by Newton's method
// from equal arcs, without an optimiser. 2.98228; Luus has 2.983.
double by_switching_times() {
  Eigen::Vector4d durations = Eigen::Vector4d::Constant(0.75);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector4d here = miss(durations);
    if (here.cwiseAbs().maxCoeff() < 1e-12) return durations.sum();
    Eigen::Matrix4d slope;
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector4d by = 1e-6 * Eigen::Vector4d::Unit(k);
      slope.col(k) = (miss(durations + by) - miss(durations - by)) / 2e-6;
    }
    const Eigen::Vector4d step = slope.partialPivLu().solve(here);
    durations -= std::min(1.0, 0.3 / step.cwiseAbs().maxCoeff()) * step;
  }
  throw std::runtime_error("no switching times found");
}

double two_link_arm() {
  static const double duration = by_switching_times();
  return duration;
}

TEST(PublishedOptima, TwoLinkArmOnEqualIntervals) {
  for (const int intervals : {50, 100, 200}) {
    // A switch inside of an interval costs time: linear controls cannot make it. Measured: 0.53 / intervals^2 or more.
    const double excess = value("two-link arm, minimum time", intervals) - two_link_arm();
    EXPECT_GT(excess, 0);
    EXPECT_LT(excess, 1.0 / (intervals * intervals)) << intervals;
    EXPECT_LE(excess + two_link_arm(), reference("two-link arm, minimum time"));
  }
}

// With the switches as nodes the scheme keeps its order: 4 and 6.
TEST(PublishedOptima, TwoLinkArmByArcs) {
  const auto time = [](const Scheme& scheme, int intervals) {
    return optimum(minimum_time_two_link_arm_by_arcs(scheme, intervals)).objective;
  };
  const double coarse = time(hermite_simpson(), 5) - two_link_arm(),
               fine = time(hermite_simpson(), 10) - two_link_arm();
  EXPECT_NEAR(fine, 0, 2e-6);         // measured: 1.7e-6
  EXPECT_NEAR(coarse / fine, 16, 3);  // measured: 17.6
  EXPECT_NEAR(time(lobatto4(), 10), two_link_arm(), 1e-8);
}

// Its arcs, rolled out by another method.
TEST(PublishedOptima, TwoLinkArmArrivesWhereItShould) {
  constexpr int kIntervals = 10;
  const Posed posed = minimum_time_two_link_arm_by_arcs(lobatto4(), kIntervals);
  const SolveReport report = optimum(posed);
  const auto& nlp = dynamic_cast<const Transcription<TwoLinkArm>&>(*posed.nlp);
  const std::vector<double> durations = nlp.durations(report.iterate.x);
  Eigen::Vector4d x(0, 0, 0.5, 0);
  for (int arc = 0; arc < 4; ++arc) {
    const Eigen::Vector2d u = report.iterate.x.segment<2>(nlp.u_at(arc * kIntervals + kIntervals / 2, 0));
    x = after_arc(x, u, durations[static_cast<std::size_t>(arc)]);
  }
  EXPECT_LT((x - Eigen::Vector4d(0, 0, 0.5, 0.522)).cwiseAbs().maxCoeff(), 1e-6) << x.transpose();
}

}  // namespace
}  // namespace fjr
