// The charts of the stiffness and gravity procedures.
#include <fmt/format.h>

#include <any>
#include <array>
#include <cmath>
#include <utility>

#include "model/identify/figures.h"
#include "model/identify/fit.h"
#include "model/identify/procedures.h"
#include "model/identify/staircase.h"

namespace fjr {
namespace {

// The branches as in the paper, in the order of the staircase.
constexpr std::array<std::pair<const char*, const char*>, 4> kBranches = {{{"0 to maximum", "#e377c2"},
                                                                           {"maximum to 0", "#2ca02c"},
                                                                           {"0 to minimum", "#d62728"},
                                                                           {"minimum to 0", "#111111"}}};

// What a chart has along x.
struct Axis {
  Abscissa of;
  std::string label;
};

const FittedStaircase& fitted_to(const Estimate& e) { return std::any_cast<const FittedStaircase&>(e.fitted); }

// Returns half a step [rad]; theta within this of zero counts as zero.
double zero_band(const std::vector<Landing>& points) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < points.size(); ++i) steps.push_back(std::abs(points[i].theta - points[i - 1].theta));
  return 0.5 * median(std::move(steps));
}

// Draws the landings in the paper's four branches and colours, minus a line through 0 with the given slope. With the
// fitted slope the chart shows the opening of the hysteresis.
Chart branch_chart(const std::string& title, const std::vector<Landing>& points, const Axis& x, double slope = 0) {
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

// Returns the branches with the fitted lines, and the residuals.
std::array<Chart, 2> fit_and_residuals(const std::string& title, const Estimate& e, const Axis& x) {
  const FittedStaircase& staircase = fitted_to(e);
  Chart chart = branch_chart(title, staircase.landings, x);
  std::vector<double> all_x, residuals;
  Series rising{"fit, rising", kResidualColour, Style::kLine, {}, {}},
      falling{"falling", "#9467bd", Style::kLine, {}, {}};
  for (const Landing& l : staircase.landings) {
    const double fitted = e.value[0] * x.of(l) + (l.rising ? staircase.rising : staircase.falling);
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

std::vector<Chart> stiffness_charts(const Estimate& e) {
  const std::string title = fmt::format("Fig. {}: stiffness of joint {}", 3 + e.joint, e.joint + 1);
  const Axis deflection{deflection_of, "theta - q [rad]"};
  const auto [fit, residuals] = fit_and_residuals(title, e, deflection);
  Chart loop = branch_chart(title + ", hysteresis", fitted_to(e).landings, deflection, e.value[0]);
  loop.y_label = "tau - K (theta - q) [N m]";
  return {fit, loop, residuals};
}

std::vector<Chart> gravity_charts(const Estimate& e) {
  const std::string title = fmt::format("Fig. {}: gravity of joint {}", 6 + e.joint, e.joint + 1);
  const auto [fit, residuals] = fit_and_residuals(title, e, {sine_of_angle, "sin q"});
  const Axis angle{[](const Landing& l) { return l.q; }, "q [rad]"};
  return {branch_chart(title + " over q", fitted_to(e).landings, angle), fit, residuals};
}

}  // namespace fjr
