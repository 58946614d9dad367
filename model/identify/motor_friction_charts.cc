// The charts of the motor friction procedure.
#include <fmt/format.h>

#include <algorithm>
#include <any>
#include <cmath>

#include "model/friction.h"
#include "model/identify/figures.h"
#include "model/identify/friction_fit.h"
#include "model/identify/procedures.h"

namespace fjr {
namespace {

// Returns tau of the law over the speed, with logarithmic spacing because the kinks are at low speeds.
Series law_curve(const FrictionLaw& law, double slowest, double fastest) {
  constexpr int kPoints = 400;
  Series curve{"fit (24)", kFittedColour, Style::kLine, {}, {}};
  for (int i = 0; i <= kPoints; ++i) {
    const double v = slowest * std::pow(fastest / slowest, static_cast<double>(i) / kPoints);
    curve.x.push_back(v);
    curve.y.push_back(law.torque(v));
  }
  return curve;
}

}  // namespace

// Draws Fig. 10 of the paper, and a chart over |dtheta| on a logarithmic scale, in which the kinks are visible.
std::vector<Chart> motor_friction_charts(const Estimate& e) {
  const auto& points = std::any_cast<const std::vector<FrictionPoint>&>(e.fitted);
  const FrictionLaw law{e.at("viscous"), e.at("amplitude"), e.at("width"), e.at("second_weight"), e.at("second_shape")};
  const std::string title = fmt::format("Fig. 10: friction of motor {}", e.joint + 1);
  const std::string speed = "|dtheta| [rad/s]";
  Series measured{"measured", kMeasuredColour, Style::kRings, {}, {}}, forward = measured, backward = measured;
  forward.name = "forward";
  backward.name = "backward, tau reversed";
  backward.colour = "#e377c2";
  std::vector<double> size, residuals;
  for (const FrictionPoint& point : points) {
    measured.x.push_back(point.v);
    measured.y.push_back(point.tau);
    Series& side = point.v > 0 ? forward : backward;
    size.push_back(std::abs(point.v));
    side.x.push_back(size.back());
    side.y.push_back(std::copysign(1.0, point.v) * point.tau);
    residuals.push_back(point.tau - law.torque(point.v));
  }
  const auto [slowest, fastest] = std::minmax_element(size.begin(), size.end());
  const Series half = law_curve(law, *slowest, *fastest);
  Series whole = half;  // the law is odd
  for (std::size_t i = 0; i < half.x.size(); ++i) {
    whole.x.insert(whole.x.begin(), -half.x[i]);
    whole.y.insert(whole.y.begin(), -half.y[i]);
  }
  Chart residual = residual_chart(title, speed, "residual [N m]", size, residuals);
  residual.logarithmic_x = true;
  return {{title, "dtheta [rad/s]", "tau [N m]", {measured, whole}},
          {title + ", slow speeds", speed, "tau [N m]", {forward, backward, half}, true},
          residual};
}

}  // namespace fjr
