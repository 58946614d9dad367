#include "model/identify/staircase.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/input_error.h"
#include "model/identify/checks.h"
#include "model/identify/fit.h"
#include "model/identify/schedule.h"

namespace fjr {
namespace {

// A reversal no longer affects the hysteresis after this fraction of the largest deflection.
constexpr double kForgotten = 0.15;
constexpr std::size_t kFewestLandings = 8;  // settled landings on a branch
constexpr std::size_t kFewestAveraged = 2;  // to be averaged

std::span<const double> part(const std::vector<double>& values, std::size_t from, std::size_t to) {
  return std::span(values).subspan(from, to - from);
}

// Sets the direction of each landing, and whether it is settled, from the averages themselves.
void classify(std::vector<Landing>& all) {
  double reach = 0;
  for (const Landing& l : all) reach = std::max(reach, std::abs(l.theta));
  double before = 0, turned_at = 0;
  bool rising = !all.empty() && all.front().theta >= 0;
  for (Landing& l : all) {
    l.rising = l.theta == before ? rising : l.theta > before;
    if (l.rising != rising) turned_at = before;
    rising = l.rising;
    l.settled = std::abs(l.theta - turned_at) >= kForgotten * reach;
    before = l.theta;
  }
}

void require_motion(const Log& log, int joint, const std::vector<Landing>& all) {
  const auto [low, high] =
      std::minmax_element(all.begin(), all.end(), [](const Landing& a, const Landing& b) { return a.theta < b.theta; });
  if (all.empty() || low->theta < high->theta) return;
  throw InputError(log.source, joint_column("theta", joint), "does not move: is this the log of the other joint?");
}

std::vector<Landing> settled_ones(const Log& log, const std::vector<Landing>& all) {
  std::vector<Landing> settled;
  std::copy_if(all.begin(), all.end(), std::back_inserter(settled), [](const Landing& l) { return l.settled; });
  const auto rising = static_cast<std::size_t>(
      std::count_if(settled.begin(), settled.end(), [](const Landing& l) { return l.rising; }));
  if (rising < kFewestLandings || settled.size() - rising < kFewestLandings) {
    throw InputError(log.source, "",
                     fmt::format("{} rising and {} falling steps; at least {} of each are needed. Does `# period:` say "
                                 "how long a step takes?",
                                 rising, settled.size() - rising, kFewestLandings));
  }
  return settled;
}

Fit fit_line(const std::vector<Landing>& points, Abscissa x) {
  const auto m = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(m, 3);
  Eigen::VectorXd b(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Landing& point = points[static_cast<std::size_t>(i)];
    a(i, 0) = x(point);
    a(i, point.rising ? 1 : 2) = 1;
    b[i] = point.tau;
  }
  return linear_fit(a, b);
}

double range_of_torque(const std::vector<Landing>& points) {
  const auto [low, high] = std::minmax_element(points.begin(), points.end(),
                                               [](const Landing& a, const Landing& b) { return a.tau < b.tau; });
  return high->tau - low->tau;
}

std::vector<Landing> without_outliers(const std::vector<Landing>& points, const Fit& fit) {
  const std::vector<bool> inside = inliers({fit.residuals.data(), points.size()}, 1e-3 * range_of_torque(points));
  std::vector<Landing> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (inside[i]) kept.push_back(points[i]);
  }
  return kept;
}

// Returns the sum of squares about the mean [(N m)^2].
double scatter(const std::vector<Landing>& points) {
  double mean = 0, square = 0;
  for (const Landing& l : points) mean += l.tau / static_cast<double>(points.size());
  for (const Landing& l : points) square += (l.tau - mean) * (l.tau - mean);
  return square;
}

}  // namespace

std::vector<Landing> landings(const Log& log, int joint, std::vector<std::string>& warnings) {
  const Schedule schedule = schedule_of(log, joint, warnings);
  const std::vector<double>& time = log.column("time");
  const std::vector<double>& theta = log.column(joint_column("theta", joint));
  const std::vector<double>& q = log.column(joint_column("q", joint));
  const std::vector<double>& tau = log.column(joint_column("tau", joint));
  std::vector<Landing> all;
  std::size_t rejected = 0;
  const auto row_at = [&](double t) {
    return static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), t - 1e-9) - time.begin());
  };
  for (int step = 1;; ++step) {
    const double end = schedule.start + step * schedule.period;
    const std::size_t first = row_at(end - schedule.average), to = row_at(end);
    if (first >= time.size()) break;
    if (to - first < kFewestAveraged) continue;
    const Average torque = robust_mean(part(tau, first, to));
    rejected += torque.rejected;
    all.push_back(
        {robust_mean(part(theta, first, to)).mean, robust_mean(part(q, first, to)).mean, torque.mean, true, true});
  }
  warn_of_gaps(log, warnings);
  warn_of_outliers(rejected, "torque samples", warnings);
  classify(all);
  require_motion(log, joint, all);
  return all;
}

double branch_slope(const Log& log, const std::vector<Landing>& points, Abscissa x) {
  return fit_line(settled_ones(log, points), x).value[0];
}

void fit_branches(const Log& log, const std::vector<Landing>& points, Abscissa x, Estimate& estimate) {
  const std::vector<Landing> settled = settled_ones(log, points);
  const std::vector<Landing> kept = without_outliers(settled, fit_line(settled, x));
  Fit fit = fit_line(kept, x);
  allow_for_correlation(fit);
  warn_of_outliers(settled.size() - kept.size(), "steps", estimate.warnings);
  estimate.value = fit.value.head(1);
  estimate.covariance = fit.covariance.topLeftCorner(1, 1);
  warn_of_doubt(estimate);
  estimate.points = kept.size();
  estimate.residual_rms = fit.residual_rms;
  estimate.residual_unit = "N m";
  estimate.r_squared = 1 - fit.residuals.squaredNorm() / scatter(kept);
  estimate.fitted = FittedStaircase{points, fit.value[1], fit.value[2]};
}

}  // namespace fjr
