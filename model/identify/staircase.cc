#include "model/identify/staircase.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/input_error.h"
#include "model/identify/checks.h"
#include "model/identify/figures.h"
#include "model/identify/fit.h"
#include "model/identify/schedule.h"

namespace fjr {
namespace {

// A reversal no longer affects the hysteresis after this fraction of the largest deflection.
constexpr double kForgotten = 0.15;
constexpr std::size_t kFewestLandings = 8;  // settled landings on a branch
// The branches as in the paper, in the order of the staircase.
constexpr std::array<std::pair<const char*, const char*>, 4> kBranches = {{{"0 to maximum", "#e377c2"},
                                                                           {"maximum to 0", "#2ca02c"},
                                                                           {"0 to minimum", "#d62728"},
                                                                           {"minimum to 0", "#111111"}}};
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

Fit fit_line(const std::vector<Landing>& points, double (*x_of)(const Landing&)) {
  const auto m = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(m, 3);
  Eigen::VectorXd b(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Landing& point = points[static_cast<std::size_t>(i)];
    a(i, 0) = x_of(point);
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

// Returns half a step [rad]; theta within this of zero counts as zero.
double zero_band(const std::vector<Landing>& points) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < points.size(); ++i) steps.push_back(std::abs(points[i].theta - points[i - 1].theta));
  return 0.5 * median(std::move(steps));
}

std::vector<Chart> charts_of(const std::string& title, const std::vector<Landing>& points, const Abscissa& x,
                             const Fit& fit) {
  Chart chart = branch_chart(title, points, x);
  std::vector<double> all_x, residuals;
  Series rising{"fit, rising", kResidualColour, Style::kLine, {}, {}},
      falling{"falling", "#9467bd", Style::kLine, {}, {}};
  for (const Landing& l : points) {
    const double fitted = fit.value[0] * x.of(l) + fit.value[l.rising ? 1 : 2];
    Series& line = l.rising ? rising : falling;
    line.x.push_back(x.of(l));
    line.y.push_back(fitted);
    all_x.push_back(x.of(l));
    residuals.push_back(l.tau - fitted);
  }
  chart.series.push_back(std::move(rising));
  chart.series.push_back(std::move(falling));
  return {chart, residual_chart(title, x.label, "residual [N m]", std::move(all_x), std::move(residuals))};
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

Chart branch_chart(const std::string& title, const std::vector<Landing>& points, const Abscissa& x, double slope) {
  Chart chart{title, x.label, "tau [N m]", {}};
  for (const auto& [name, colour] : kBranches) chart.series.push_back({name, colour, Style::kDots, {}, {}});
  for (const Landing& l : points) {
    // A branch ends at zero. The middle of the first step away from it decides to which branch a landing belongs.
    const bool positive = l.rising ? l.theta > zero_band(points) : l.theta >= -zero_band(points);
    Series& series = chart.series[positive ? (l.rising ? 0 : 1) : (l.rising ? 3 : 2)];
    series.x.push_back(x.of(l));
    series.y.push_back(l.tau - slope * x.of(l));
  }
  return chart;
}

double branch_slope(const Log& log, const std::vector<Landing>& points, const Abscissa& x) {
  return fit_line(settled_ones(log, points), x.of).value[0];
}

void fit_branches(const Log& log, const std::vector<Landing>& points, const Abscissa& x, const std::string& title,
                  Estimate& estimate) {
  const std::vector<Landing> settled = settled_ones(log, points);
  const std::vector<Landing> kept = without_outliers(settled, fit_line(settled, x.of));
  Fit fit = fit_line(kept, x.of);
  allow_for_correlation(fit);
  warn_of_outliers(settled.size() - kept.size(), "steps", estimate.warnings);
  estimate.value = fit.value.head(1);
  estimate.covariance = fit.covariance.topLeftCorner(1, 1);
  warn_of_doubt(estimate);
  estimate.points = kept.size();
  estimate.residual_rms = fit.residual_rms;
  estimate.residual_unit = "N m";
  estimate.r_squared = 1 - fit.residuals.squaredNorm() / scatter(kept);
  estimate.charts = charts_of(title, points, x, fit);
}

}  // namespace fjr
