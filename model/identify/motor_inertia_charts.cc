// The charts of the motor inertia procedure.
#include <fmt/format.h>

#include <any>
#include <cmath>
#include <iterator>
#include <utility>

#include "model/identify/figures.h"
#include "model/identify/procedures.h"
#include "model/identify/responses.h"

namespace fjr {
namespace {

// Draws one of the paper's two figures: the responses to the torques of one sign.
Chart response_chart(const std::string& title, const std::string& y_label, const FittedResponses& responses,
                     double sign) {
  constexpr const char* kColours[] = {"#1f77b4", "#ff7f0e", "#9467bd", "#8c564b", "#17becf", "#bcbd22"};
  Chart chart{title, "time [s]", y_label, {}};
  Series fitted{"fits", kFittedColour, Style::kLine, {}, {}};
  Eigen::Index i = 0;
  for (const Response& r : responses.all) {
    const Eigen::Index begin = i;
    i += static_cast<Eigen::Index>(r.y.size());
    if (r.u * sign <= 0) continue;
    chart.series.push_back({fmt::format("u = {:.3g} N m", r.u), kColours[chart.series.size() % std::size(kColours)],
                            Style::kDots, r.time, r.y});
    for (std::size_t row = 0; row < r.y.size(); ++row) {
      fitted.x.push_back(r.time[row]);
      fitted.y.push_back(r.y[row] + responses.residuals[begin + static_cast<Eigen::Index>(row)]);
    }
    fitted.x.push_back(NAN);  // the next curve begins anew
    fitted.y.push_back(NAN);
  }
  chart.series.insert(chart.series.begin(), std::move(fitted));
  return chart;
}

}  // namespace

std::vector<Chart> motor_inertia_charts(const Estimate& e) {
  const auto& fitted = std::any_cast<const FittedResponses&>(e.fitted);
  const bool velocities = fitted.measured == Measured::kVelocity;
  const std::string what = velocities ? "velocity" : "position",
                    y_label = velocities ? "dtheta [rad/s]" : "theta [rad]";
  const int forward = 11 + 2 * e.joint, backward = forward + 1;  // figures of the paper
  const auto title = [&](int figure) {
    return fmt::format("Fig. {}: {} responses of motor {}", figure, what, e.joint + 1);
  };
  std::vector<double> time;
  for (const Response& r : fitted.all) time.insert(time.end(), r.time.begin(), r.time.end());
  return {response_chart(title(forward), y_label, fitted, 1), response_chart(title(backward), y_label, fitted, -1),
          residual_chart(fmt::format("Figs. {} and {}", forward, backward), "time [s]",
                         velocities ? "residual [rad/s]" : "residual [rad]", std::move(time),
                         measured_less_fitted(fitted.residuals))};
}

}  // namespace fjr
