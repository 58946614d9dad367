// Fits of lines and curves, and robust means, whose results are known.
#include "model/identify/fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/normal.h"
#include "model/identify/arm.h"

namespace fjr {
namespace {

// A certified linear regression: Longley's would need six regressors; Norris (NIST StRD) shows the digits as well.
TEST(LinearFit, AgreesWithTheCertifiedNorrisRegression) {
  const double y[] = {.1, 338.8, 118.1, 888.0, 9.2,   228.1, 668.5, 998.5, 449.1, 778.9, 559.2, .3,
                      .1, 778.1, 668.8, 339.3, 448.9, 10.8,  557.7, 228.3, 998.0, 888.8, 119.6, .3,
                      .6, 557.6, 339.3, 888.0, 998.5, 778.9, 10.2,  117.6, 228.9, 668.4, 449.2, .2};
  const double x[] = {.2, 337.4, 118.2, 884.6, 10.1,  226.5, 666.3, 996.3, 448.6, 777.0, 558.2, .4,
                      .6, 775.5, 666.9, 338.0, 447.5, 11.6,  556.0, 228.1, 995.8, 887.6, 120.2, .3,
                      .3, 556.8, 339.1, 887.2, 999.0, 779.0, 11.1,  118.3, 229.2, 669.1, 448.9, .5};
  Eigen::MatrixXd a(36, 2);
  Eigen::VectorXd b(36);
  for (Eigen::Index i = 0; i < 36; ++i) {
    a.row(i) << 1, x[i];
    b[i] = y[i];
  }
  const Fit fit = linear_fit(a, b);
  EXPECT_NEAR(fit.value[0], -0.262323073774029, 1e-12);
  EXPECT_NEAR(fit.value[1], 1.00211681802045, 1e-13);
  EXPECT_NEAR(std::sqrt(fit.covariance(0, 0)), 0.232818234301152, 1e-11);
  EXPECT_NEAR(std::sqrt(fit.covariance(1, 1)), 0.429796848199937e-3, 1e-14);
}

TEST(LinearFit, SaysWhenTheDataDoNotDetermineEverything) {
  Eigen::MatrixXd a(4, 2);
  a << 1, 2, 2, 4, 3, 6, 4, 8;
  EXPECT_FALSE(linear_fit(a, Eigen::VectorXd::Ones(4)).determined);
}

TEST(CurveFit, FindsAnExponentialAndItsUncertainty) {
  const Residuals residuals = [](const Eigen::VectorXd& p, Eigen::VectorXd& r) {
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const double t = 0.1 * static_cast<double>(i);
      r[i] = p[0] * std::exp(-p[1] * t) - 2 * std::exp(-0.7 * t) - (i % 2 == 0 ? 1e-3 : -1e-3);
    }
  };
  const Fit fit = curve_fit(residuals, 50, Eigen::Vector2d(1, 1));
  EXPECT_NEAR(fit.value[0], 2, 1e-3);
  EXPECT_NEAR(fit.value[1], 0.7, 1e-3);
  EXPECT_NEAR(fit.residual_rms, 1e-3, 1e-5);
  EXPECT_LT(std::sqrt(fit.covariance(1, 1)), 1e-3);
}

// A line through noise that stays the same for 50 samples at a time: of 1000 samples only 20 are independent.
TEST(LinearFit, CorrelatedResidualsAreNotTakenForIndependentOnes) {
  constexpr int kSamples = 1000, kSame = 50, kRepetitions = 100;
  Normal normal(5);
  double square = 0, told = 0, naive = 0;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    Eigen::MatrixXd a(kSamples, 2);
    Eigen::VectorXd b(kSamples);
    double noise = 0;
    for (Eigen::Index i = 0; i < kSamples; ++i) {
      if (i % kSame == 0) noise = normal();
      a.row(i) << 1, static_cast<double>(i) / kSamples;
      b[i] = noise;
    }
    Fit fit = linear_fit(a, b);
    square += fit.value[1] * fit.value[1] / kRepetitions;
    naive += fit.covariance(1, 1) / kRepetitions;
    allow_for_correlation(fit);
    told += fit.covariance(1, 1) / kRepetitions;
  }
  EXPECT_LT(naive, 0.05 * square);
  EXPECT_GT(told, 0.6 * square);  // 20 clusters: known to be a little small
  EXPECT_LT(told, 1.4 * square);
}

TEST(RobustMean, ForgetsOutliersAndKeepsCounts) {
  EXPECT_NEAR(robust_mean(std::vector<double>{1, 1.1, 0.9, 1, 1.05, 0.95, 50}).mean, 1, 1e-12);
  EXPECT_EQ(robust_mean(std::vector<double>{1, 1.1, 0.9, 1, 1.05, 0.95, 50}).rejected, 1U);
  EXPECT_NEAR(robust_mean(std::vector<double>{2, 2, 2, 2.001, 2, 2}).mean, 2 + 0.001 / 6, 1e-12);
}

}  // namespace
}  // namespace fjr
