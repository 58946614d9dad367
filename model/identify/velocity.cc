#include "model/identify/velocity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "model/encoder.h"
#include "model/identify/checks.h"
#include "model/identify/fit.h"

namespace fjr {
namespace {

constexpr double kWhole = 0.01;       // of a count: how far from whole numbers of counts a differentiated angle is
constexpr double kEnoughCounts = 20;  // turned, to compare with
constexpr double kConsistentVelocity = 1.5;  // times or part of each other
constexpr double kMostSamples = 0.98;        // of the samples

Fit line(std::span<const double> x, std::span<const double> y) {
  const auto m = static_cast<Eigen::Index>(x.size());
  Eigen::MatrixXd a(m, 2);
  Eigen::VectorXd b(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const auto row = static_cast<std::size_t>(i);
    a.row(i) << 1, x[row] - x.front();
    b[i] = y[row] - y.front();
  }
  return linear_fit(a, b);
}

// The number of independent quantisation errors is the number of counts passed or, for a finer angle, that of rows.
Speed slope_of(std::span<const double> time, std::span<const double> theta, double count) {
  const Fit fit = line(time, theta);
  const double duration = time.back() - time.front(), turned = std::abs(fit.value[1]) * duration;
  const double independent = std::min(turned / count + 1, static_cast<double>(time.size()));
  const bool counts = fit.residual_rms > 0.1 * count;
  const double by_counts = fit.residual_rms * std::sqrt(12 / independent) / duration;
  return {fit.value[1], std::max(counts ? by_counts : 0, std::sqrt(fit.covariance(1, 1))), 0};
}

}  // namespace

bool has_own_velocity(const Log& log, int joint, const Parameters& robot) {
  const std::string name = joint_column("dtheta", joint);
  if (!log.has(name)) return false;
  const double count = count_angle(robot.encoder.motor_counts[static_cast<std::size_t>(joint)]);
  const std::vector<double>&v = log.column(name), &time = log.column("time");
  double moving = 0, whole = 0;
  for (std::size_t i = 1; i < v.size(); ++i) {
    const double counts = v[i] * (time[i] - time[i - 1]) / count;
    if (v[i] == 0) continue;
    ++moving;
    whole += std::abs(counts) > 0.5 && std::abs(counts - std::round(counts)) < kWhole;
  }
  return whole < kMostSamples * moving;
}

Signal velocity(const Log& log, int joint, const Parameters& robot, std::size_t window) {
  if (has_own_velocity(log, joint, robot)) return {log.column(joint_column("dtheta", joint)), 0};
  const std::vector<double>&theta = log.column(joint_column("theta", joint)), &time = log.column("time");
  const double duration = static_cast<double>(window) * sample_interval(log);
  Signal v{{}, 2 * count_angle(robot.encoder.motor_counts[static_cast<std::size_t>(joint)]) / duration};
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const std::size_t from = i > window / 2 ? i - window / 2 : 0, to = std::min(from + window, theta.size() - 1);
    v.values.push_back(to > from ? (theta[to] - theta[from]) / (time[to] - time[from]) : 0);
  }
  return v;
}

Speed constant_speed(const Log& log, int joint, const Parameters& robot, const RowRange& range) {
  const auto part = [&](const std::string& column) {
    return std::span<const double>(log.column(column)).subspan(range.from, range.rows());
  };
  if (has_own_velocity(log, joint, robot)) {
    const Average average = robust_mean(part(joint_column("dtheta", joint)));
    return {average.mean, average.standard_error, average.rejected};
  }
  return slope_of(part("time"), part(joint_column("theta", joint)),
                  count_angle(robot.encoder.motor_counts[static_cast<std::size_t>(joint)]));
}

void require_consistent_velocity(const Log& log, int joint, const Parameters& robot,
                                 const std::vector<RowRange>& ranges) {
  if (!has_own_velocity(log, joint, robot)) return;
  const std::string name = joint_column("dtheta", joint), angle = joint_column("theta", joint);
  const std::vector<double>&v = log.column(name), &theta = log.column(angle), &time = log.column("time");
  const double count = count_angle(robot.encoder.motor_counts[static_cast<std::size_t>(joint)]);
  std::vector<double> ratios;  // of turned by dtheta to turned by theta
  for (const RowRange& s : ranges) {
    const double turned = theta[s.to - 1] - theta[s.from];
    if (s.rows() < 2 || std::abs(turned) < kEnoughCounts * count) continue;
    double mean = 0;
    for (std::size_t row = s.from; row < s.to; ++row) mean += v[row] / static_cast<double>(s.rows());
    ratios.push_back(mean * (time[s.to - 1] - time[s.from]) / turned);
  }
  if (ratios.empty()) return;  // slow, or theta was not recorded
  require_plausible(log, fmt::format("{} in proportion to the change of {}", name, angle), median(ratios), 1,
                    kConsistentVelocity);
}

}  // namespace fjr
