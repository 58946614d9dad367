// The charts of the link inertia procedure.
#include <fmt/format.h>

#include <any>
#include <cmath>
#include <utility>

#include "model/identify/figures.h"
#include "model/identify/procedures.h"
#include "model/identify/swing.h"

namespace fjr {
namespace {

// Draws the crests and their envelope, and the whole curve with the fitted one.
Chart decay_chart(const std::string& title, const FittedDecay& fitted) {
  Series crests{"crests", kMeasuredColour, Style::kRings, {}, {}},
      envelope{"envelope (10)", "#888", Style::kLine, {}, {}};
  for (const Crest& top : fitted.crests) {
    crests.x.push_back(top.time);
    crests.y.push_back(top.height);
  }
  const Curve& decay = fitted.decay;
  for (int i = 0; i <= 100; ++i) {
    envelope.x.push_back(decay.time.front() + (decay.time.back() - decay.time.front()) * i / 100);
    envelope.y.push_back(std::exp(fitted.line[0] + fitted.line[1] * envelope.x.back()));
  }
  Series fit{"fit", kFittedColour, Style::kLine, decay.time, {}};
  for (std::size_t i = 0; i < decay.q.size(); ++i) {
    fit.y.push_back(decay.q[i] + fitted.residuals[static_cast<Eigen::Index>(i)]);
  }
  const Series measured{"measured", kResidualColour, Style::kDots, fitted.whole.time, fitted.whole.q};
  return {title, "time [s]", "q [rad]", {crests, fit, envelope, measured}};
}

// Draws the paper's logarithmic decrement: ln q_peak over time with its line (12), and the damping D/I [1/s] of the
// fitted curve, from which hysteresis is excluded.
Chart decrement_chart(const std::string& title, const FittedDecay& fitted, double damping_over_inertia) {
  const std::vector<Crest>& tops = fitted.crests;
  const Eigen::Vector2d& line = fitted.line;
  const double viscous = -0.5 * damping_over_inertia, middle = 0.5 * (tops.front().time + tops.back().time);
  Series measured{"ln q peak", kMeasuredColour, Style::kRings, {}, {}};
  Series all{fmt::format("line (12): {:.4f}/s", line[1]), kFittedColour, Style::kLine, {}, {}};
  Series damping{fmt::format("without hysteresis: {:.4f}/s", viscous), "#888", Style::kLine, {}, {}};
  for (const Crest& top : tops) {
    for (Series* s : {&measured, &all, &damping}) s->x.push_back(top.time);
    measured.y.push_back(std::log(top.height));
    all.y.push_back(line[0] + line[1] * top.time);
    damping.y.push_back(line[0] + line[1] * middle + viscous * (top.time - middle));
  }
  return {title + ", decrement", "time [s]", "ln(q peak / rad)", {measured, all, damping}};
}

}  // namespace

std::vector<Chart> link_inertia_charts(const Estimate& e) {
  const auto& fitted = std::any_cast<const FittedDecay&>(e.fitted);
  const std::string title = fmt::format("Fig. {}: free decay of link {}", 8 + e.joint, e.joint + 1);
  return {
      decay_chart(title, fitted), decrement_chart(title, fitted, e.at("damping_over_inertia")),
      residual_chart(title, "time [s]", "residual [rad]", fitted.decay.time, measured_less_fitted(fitted.residuals))};
}

}  // namespace fjr
