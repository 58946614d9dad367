// Parameters from motions that the executor's own control tick ran on an arm that is not the one planned for.
#include "planner/identify/executed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <random>

#include "common/dual.h"
#include "common/input_error.h"
#include "common/parallel.h"
#include "planner/identify/executed_robot.h"
#include "tests/identify/executions.h"

namespace fjr {
namespace {

using testing::HasSubstr;

const RefinedParameter& named(const ExecutedFit& fit, const std::string& name) {
  for (const RefinedParameter& p : fit.parameters) {
    if (p.name == name) return p;
  }
  throw std::out_of_range(name);
}

// In standard errors.
double off_truth(const RefinedParameter& p, Parameters truth) {
  return (p.after - *parameter_named(truth, p.name)) / p.error;
}

// The arm has springs 5 % softer, a fifth more viscous friction and 0.1 kg that nobody planned with.
TEST(Executed, ThreeMotionsMakeTheNextOnesFiveTimesAsExact) {
  const Parameters truth = wrong_arm();
  const Executions before = executed(robot(), {.truth = truth});
  const ExecutedFit fit = fit_executed(robot(), prior_of(robot()), before.motions, kTwoThreads);
  EXPECT_TRUE(fit.converged);
  // Counts alone: 1, with a standard deviation of 0.01 for ten thousand independent readings, which neighbours are not.
  EXPECT_NEAR(fit.chi_square, 1, 0.05);
  for (const RefinedParameter& p : fit.parameters) {
    EXPECT_TRUE(p.refined()) << p.name;
    EXPECT_LT(std::abs(off_truth(p, truth)), 3.5) << p.name;  // of 13 normal numbers in one of 200 logs
  }
  const Executions after = executed(fit.robot, {.truth = truth});
  for (std::size_t i = 0; i < kMoves.size(); ++i) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      EXPECT_LT(after.results[i].link_error_rms[j], before.results[i].link_error_rms[j] / 5) << i << ", " << j;
      EXPECT_LT(after.results[i].link_error_rms[j], 1e-4);                  // a count; measured: 3e-5 to 5e-5
      EXPECT_LT(fit.motions[i].after[static_cast<Eigen::Index>(j)], 4e-5);  // counts alone make 2.8e-5
    }
  }
}

using Slopes = Eigen::Matrix<double, kStates, 1>;

Slopes slopes_of(const Parameters& p, const std::string& name, const State<double>& x, const Joints<double>& torque,
                 const Slopes& s) {
  using Active = Dual<kStates>;
  State<Active> active;
  for (int i = 0; i < kStates; ++i)
    active[static_cast<std::size_t>(i)] = Active::input(x[static_cast<std::size_t>(i)], i);
  const State<Active> f = dynamics<Active>(p, active, {Active(torque[0]), Active(torque[1])});
  Parameters more = p, less = p;
  const double step = 1e-6 * *parameter_named(more, name);
  *parameter_named(more, name) += step;
  *parameter_named(less, name) -= step;
  const State<double> above = dynamics<double>(more, x, torque), below = dynamics<double>(less, x, torque);
  Slopes rate;
  for (std::size_t i = 0; i < kStates; ++i) {
    rate[static_cast<Eigen::Index>(i)] = (above[i] - below[i]) / (2 * step);
    for (std::size_t k = 0; k < kStates; ++k) {
      rate[static_cast<Eigen::Index>(i)] += f[i].g[k] * s[static_cast<Eigen::Index>(k)];
    }
  }
  return rate;
}

State<double> moved_by(const State<double>& x, const State<double>& rate, double h) {
  State<double> next;
  for (std::size_t i = 0; i < kStates; ++i) next[i] = x[i] + h * rate[i];
  return next;
}

// The variational equation dS/dt = df/dx S + df/dp, with the motion, by the midpoint rule at 5 us: the friction's rate
// at the kink of joint 1 is 8e4/s.
TEST(Executed, SlopesAreThoseOfTheVariationalEquation) {
  const Executions run = executed(robot(), {.truth = robot()}, {{{0, 0}, {0.9, -1.1}, 0.5}});
  const ExecutedMotion& motion = run.motions.front();
  const ReplayedPiece piece = pieces_of(robot(), motion, 0).at(0);
  constexpr int kParts = 200;
  constexpr std::size_t kRows = 200;
  for (const char* name :
       {"spring.stiffness[0]", "friction.viscous[1]", "link.gravity_torque[0]", "motor.inertia[1]"}) {
    Parameters more = robot(), less = robot();
    const double step = kSlopeStep * *parameter_named(more, name);
    *parameter_named(more, name) += step;
    *parameter_named(less, name) -= step;
    const Eigen::VectorXd differences =
        (*replayed(more, motion, piece, piece.begins) - *replayed(less, motion, piece, piece.begins)) / (2 * step);
    State<double> x = piece.begins;
    Slopes s = Slopes::Zero();
    double largest = 0, worst = 0;
    for (std::size_t row = 0; row < kRows; ++row) {
      const Eigen::Vector4d found = differences.segment<4>(4 * static_cast<Eigen::Index>(row));
      const Eigen::Vector4d expected(s[kStateQ], s[kStateQ + 1], s[kStateTheta], s[kStateTheta + 1]);
      largest = std::max(largest, expected.cwiseAbs().maxCoeff());
      worst = std::max(worst, (found - expected).cwiseAbs().maxCoeff());
      const Joints<double>& torque = motion.torque[piece.first + row];
      const double h = (motion.times[piece.first + row + 1] - motion.times[piece.first + row]) / kParts;
      for (int part = 0; part < kParts; ++part) {
        const State<double> middle = moved_by(x, dynamics<double>(robot(), x, torque), h / 2);
        const Slopes half = s + h / 2 * slopes_of(robot(), name, x, torque, s);
        s += h * slopes_of(robot(), name, middle, torque, half);
        x = moved_by(x, dynamics<double>(robot(), middle, torque), h);
      }
    }
    EXPECT_GT(largest, 0) << name;
    EXPECT_LT(worst, 2e-3 * largest) << name;
  }
}

Parameters uncertain_by(double fraction, const std::vector<std::string>& more = {}) {
  Parameters p = robot();
  Uncertainty u;
  u.names = prior_of(robot()).names;
  u.names.pop_back();  // the payload's mass
  u.names.insert(u.names.end(), more.begin(), more.end());
  u.covariance =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(u.names.size()), static_cast<Eigen::Index>(u.names.size()));
  for (std::size_t i = 0; i < u.names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    u.covariance(k, k) = std::pow(fraction * *parameter_named(p, u.names[i]), 2);
  }
  p.payload = {0.1, 0, 0.02, 0};
  u.payload = p.payload;
  p.uncertainty = std::make_shared<const Uncertainty>(u);
  return p;
}

Parameters drawn_from(const Parameters& known, std::mt19937& random) {
  const Uncertainty u = uncertainty_of(known);
  const Eigen::MatrixXd factor = u.factor();
  std::normal_distribution<double> normal;
  Eigen::VectorXd drawn(factor.cols());
  for (double& number : drawn) number = normal(random);
  return changed(known, u.names, factor * drawn);
}

// Of 12 arms at 95 %, 8 or fewer would be covered with a probability of 0.0022 for each parameter. The rms of errors
// in standard errors is that of 12 numbers as good as independent, for one motion tells all parameters together: 1 +-
// 0.2, of which 0.45 is as many as 0.35 is of 20 arms' 0.16.
TEST(Executed, IntervalsCoverTheTruth) {
  constexpr int kArms = 12;
  const Parameters known = uncertain_by(0.02);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-0.6, 0.6);
  std::map<std::string, int> covered;
  double squares = 0, count = 0;
  for (int i = 0; i < kArms; ++i) {
    const Parameters truth = drawn_from(known, random);
    const Joints<double> from{place(random), place(random)}, to{from[0] + 0.9, from[1] - 1.1};
    const Executions run = executed(known, {.truth = truth}, {{from, to, 0.5}});
    const ExecutedFit fit = fit_executed(known, prior_of(known), run.motions, kTwoThreads);
    EXPECT_TRUE(fit.converged) << i;
    for (const RefinedParameter& p : fit.parameters) {
      const double off = off_truth(p, truth);
      covered[p.name] += std::abs(off) < 1.96 ? 1 : 0;
      squares += off * off;
      ++count;
    }
  }
  for (const auto& [name, of_arms] : covered) {
    RecordProperty(name, of_arms);
    EXPECT_GE(of_arms, 9) << name;
  }
  EXPECT_NEAR(std::sqrt(squares / count), 1, 0.45);
}

// The kink of joint 1's friction lies at 1.45e-4 rad/s, which no ordinary motion has for longer than a tick.
TEST(Executed, WhatIsNotExcitedKeepsItsPrior) {
  const std::string kink = "friction.second_shape[0]";
  const Parameters known = uncertain_by(0.02, {kink});
  const Executions run = executed(known, {.truth = known}, {{{0, 0}, {0.9, -1.1}, 0.5}});
  const ExecutedFit fit = fit_executed(known, prior_of(known), run.motions, kTwoThreads);
  const RefinedParameter& p = named(fit, kink);
  EXPECT_FALSE(p.refined());
  EXPECT_GT(p.error, 0.8 * p.prior_error);
  EXPECT_LT(std::abs(p.standard_errors_moved()), 1);
  EXPECT_TRUE(named(fit, "spring.stiffness[0]").refined());
}

// Errors that go together: knowing the payload's mass leaves of the other's variance 1 - correlation^2.
TEST(Prior, AKnownPayloadIsNotToBeFound) {
  const auto has_mass = [](const Prior& prior) {
    return std::find(prior.names.begin(), prior.names.end(), "payload.mass") != prior.names.end();
  };
  EXPECT_TRUE(has_mass(prior_of(robot())));
  EXPECT_FALSE(has_mass(prior_of(robot(), 1, PayloadMass::kKnown)));
  Parameters p = robot();
  p.payload = {0.1, 0, 0.02, 0};
  Uncertainty u;
  u.names = {"payload.mass", "spring.stiffness[0]"};
  u.covariance = (Eigen::Matrix2d() << 4e-4, 0.6 * 0.02 * 0.3, 0.6 * 0.02 * 0.3, 0.09).finished();
  u.payload = p.payload;
  p.uncertainty = std::make_shared<const Uncertainty>(u);
  const Prior known = prior_of(p, 1, PayloadMass::kKnown);
  EXPECT_FALSE(has_mass(known));
  ASSERT_EQ(known.names.front(), "spring.stiffness[0]");
  EXPECT_NEAR(known.deviation[0], 0.3 * std::sqrt(1 - 0.6 * 0.6), 1e-12);
}

TEST(Executed, WritesWhatItFound) {
  const std::string kink = "friction.second_shape[0]";
  const Parameters known = uncertain_by(0.02, {kink});
  const Executions run = executed(known, {.truth = wrong_arm()}, {{{0, 0}, {0.9, -1.1}, 0.5}});
  const ExecutedFit fit = fit_executed(known, prior_of(known), run.motions, kTwoThreads);
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("fjr_refined_" + std::to_string(::getpid()) + ".yaml");
  const Parameters written = write_executed_robot(file, default_robot_file(), fit, run.motions);
  EXPECT_EQ(robot_hash(written), robot_hash(fit.robot));
  const Uncertainty u = uncertainty_of(written);
  ASSERT_EQ(u.names.size(), fit.parameters.size());
  for (std::size_t i = 0; i < u.names.size(); ++i) {
    for (std::size_t k = 0; k < u.names.size(); ++k) {
      const auto index = [&](const std::string& name) { return &named(fit, name) - fit.parameters.data(); };
      const double expected = fit.covariance(index(u.names[i]), index(u.names[k]));
      EXPECT_NEAR(u.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)), expected,
                  1e-9 * std::abs(expected))
          << u.names[i] << ", " << u.names[k];
    }
  }
  std::ifstream in(file);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  std::filesystem::remove(file);
  EXPECT_THAT(text, HasSubstr("sha256 " + run.motions.front().hash));
  EXPECT_THAT(text, HasSubstr("kept, as its logs hardly tell it"));
  // Another payload is no longer the one that the covariance is about; what is known of the arm stays.
  Parameters other = written;
  other.payload = {0.3, 0, 0, 0};
  EXPECT_EQ(uncertainty_of(other).names.size(), u.names.size() - 1);
}

std::string error_of(const Log& log) {
  try {
    executed_motion(log);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Executed, RefusesLogsThatDoNotSayWhatMovedTheArm) {
  Log log;
  log.source = "run.csv";
  for (const char* name :
       {"time", "q1", "q2", "theta1", "theta2", "tau1", "tau2", "q1_plan", "q2_plan", "theta1_plan"}) {
    log.names.emplace_back(name);
    log.values.emplace_back();
    for (int i = 0; i < 200; ++i) log.values.back().push_back(1e-3 * i);
  }
  EXPECT_EQ(error_of(log), "run.csv: theta2_plan: this column is needed and missing");
  log.names.emplace_back("theta2_plan");
  log.values.push_back(log.values.back());
  EXPECT_EQ(error_of(log), "");
  log.metadata["missed_ticks"] = "7";
  EXPECT_THAT(error_of(log), HasSubstr("run.csv: # missed_ticks: 7, of which 0 are to be seen in the times"));
  log.metadata.clear();
  for (std::size_t i = 100; i < 200; ++i) log.column("time")[i] += 0.02;
  EXPECT_THAT(error_of(log), HasSubstr("run.csv: time, row 101: 0.021 s after the row before"));
  for (std::vector<double>& column : log.values) column.resize(20);
  EXPECT_THAT(error_of(log), HasSubstr("the plan moves for 20 rows"));
}

}  // namespace
}  // namespace fjr
