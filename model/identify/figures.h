// What the charts of several procedures have in common.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "common/chart.h"

namespace fjr {

inline constexpr const char* kMeasuredColour = "#d62728";
inline constexpr const char* kFittedColour = "#2ca02c";
inline constexpr const char* kResidualColour = "#1f77b4";

// Returns a chart of measured minus fitted values over x. title: that of the chart with the fit.
inline Chart residual_chart(const std::string& title, const std::string& x_label, const std::string& y_label,
                            std::vector<double> x, std::vector<double> residuals) {
  return {"Residuals of " + title,
          x_label,
          y_label,
          {{"residual", kResidualColour, Style::kDots, std::move(x), std::move(residuals)}}};
}

// Returns measured minus fitted values, for residual_chart(): the residuals of a fit have the other sign.
inline std::vector<double> measured_less_fitted(const Eigen::VectorXd& residuals) {
  std::vector<double> values;
  for (const double r : residuals) values.push_back(-r);
  return values;
}

}  // namespace fjr
