#include "model/identify/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace fjr {
namespace {

constexpr double kWidth = 560, kLeft = 70, kRight = 15, kTop = 12, kBottom = 38;
constexpr std::size_t kMostPoints = 1500;  // drawn of a plot: more cannot be told apart

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Identification</title><style>
body { font: 15px/1.5 system-ui, sans-serif; max-width: 1200px; margin: 2em auto; padding: 0 1em; color: #222; }
section { border-top: 1px solid #ddd; padding: 1em 0; }
table { border-collapse: collapse; } td, th { padding: 2px 14px 2px 0; text-align: left; }
td.n { text-align: right; font-variant-numeric: tabular-nums; }
svg { max-width: 100%; } svg text { font-size: 12px; fill: #444; }
.warning { color: #a40; } .log { color: #777; font-size: 13px; overflow-wrap: anywhere; }
</style></head><body>
)";

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else if (c == '&') {
      result += "&amp;";
    } else {
      result += c;
    }
  }
  return result;
}

struct Range {
  double low, high;
};

Range range_of(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double margin = *high > *low ? 0.04 * (*high - *low) : 1e-12;
  return {*low - margin, *high + margin};
}

// A round number of which about five fit into the range.
double tick_step(const Range& range) {
  const double raw = (range.high - range.low) / 5, power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * power) return factor * power;
  }
  return 10 * power;
}

class Axes {
 public:
  Axes(const Range& x, const Range& y, double height) : x_(x), y_(y), height_(height) {}

  double x(double value) const { return kLeft + (value - x_.low) / (x_.high - x_.low) * (kWidth - kLeft - kRight); }
  double y(double value) const {
    return height_ - kBottom - (value - y_.low) / (y_.high - y_.low) * (height_ - kTop - kBottom);
  }

  std::string frame(const std::string& x_label, const std::string& y_label) const {
    const double bottom = height_ - kBottom;
    std::string svg = fmt::format(
        "<rect x='{}' y='{}' width='{}' height='{}' fill='none' stroke='#bbb'/>"
        "<text x='{}' y='{}' text-anchor='middle'>{}</text>"
        "<text x='14' y='{}' text-anchor='middle' transform='rotate(-90 14 {})'>{}</text>",
        kLeft, kTop, kWidth - kLeft - kRight, bottom - kTop, (kLeft + kWidth) / 2, height_ - 6, escaped(x_label),
        (kTop + bottom) / 2, (kTop + bottom) / 2, escaped(y_label));
    const double dx = tick_step(x_), dy = tick_step(y_);
    for (double v = std::ceil(x_.low / dx) * dx; v <= x_.high; v += dx) {
      svg += fmt::format("<text x='{:.1f}' y='{}' text-anchor='middle'>{:.4g}</text>", x(v), bottom + 15,
                         near_zero(v, dx));
    }
    for (double v = std::ceil(y_.low / dy) * dy; v <= y_.high; v += dy) {
      svg +=
          fmt::format("<text x='{}' y='{:.1f}' text-anchor='end'>{:.4g}</text>", kLeft - 5, y(v) + 4, near_zero(v, dy));
    }
    return svg;
  }

 private:
  static double near_zero(double value, double step) { return std::abs(value) < 1e-6 * step ? 0 : value; }

  Range x_, y_;
  double height_;
};

std::string dots(const Axes& axes, const std::vector<double>& x, const std::vector<double>& y, const char* colour,
                 double radius) {
  const std::size_t stride = x.size() / kMostPoints + 1;
  std::string path;
  for (std::size_t i = 0; i < x.size(); i += stride)
    path += fmt::format("M{:.1f} {:.1f}h0", axes.x(x[i]), axes.y(y[i]));
  return fmt::format("<path d='{}' stroke='{}' stroke-width='{}' stroke-linecap='round'/>", path, colour, 2 * radius);
}

std::string svg(double height, const std::string& content) {
  return fmt::format("<svg viewBox='0 0 {0} {1}' width='{0}' height='{1}'>{2}</svg>\n", kWidth, height, content);
}

std::string figures(const Estimate& e) {
  const Plot& plot = e.plot;
  if (plot.x.empty()) return "";
  std::vector<double> residuals;
  for (std::size_t i = 0; i < plot.x.size(); ++i) residuals.push_back(plot.y[i] - plot.fitted[i]);
  const Axes upper(range_of(plot.x), range_of(plot.y), 360), lower(range_of(plot.x), range_of(residuals), 360);
  return svg(360, upper.frame(plot.x_label, plot.y_label) + dots(upper, plot.x, plot.y, "#d33", 2.2) +
                      dots(upper, plot.x, plot.fitted, "#170", 1)) +
         svg(360, lower.frame(plot.x_label, "residual [" + e.residual_unit + "]") +
                      dots(lower, plot.x, residuals, "#36c", 1.6));
}

std::string table(const Estimate& e) {
  std::string rows = "<table><tr><th>parameter</th><th>value</th><th>standard error</th><th>unit</th></tr>\n";
  for (std::size_t i = 0; i < e.names.size(); ++i) {
    const bool assumed = std::find(e.assumed.begin(), e.assumed.end(), e.names[i]) != e.assumed.end();
    rows += fmt::format("<tr><td>{}</td><td class='n'>{:.6g}</td><td class='n'>{}</td><td>{}</td></tr>\n", e.names[i],
                        e.value[static_cast<Eigen::Index>(i)],
                        assumed ? "assumed" : fmt::format("{:.2g}", e.standard_error(e.names[i])), e.units[i]);
  }
  return rows + "</table>\n";
}

std::string section(const Estimate& e) {
  std::string html = fmt::format("<section><h2>{}</h2>\n", escaped(e.plot.title));
  html += figures(e) + table(e);
  html += fmt::format("<p>{} points, residual {:.3g} {} rms, R² = {:.8f}</p>\n", e.points, e.residual_rms,
                      e.residual_unit, e.r_squared);
  for (const std::string& warning : e.warnings) html += "<p class='warning'>" + escaped(warning) + "</p>\n";
  const std::string file = std::filesystem::path(e.log).filename().string();
  return html + fmt::format("<p class='log'>{}, SHA-256 {}</p></section>\n", escaped(file), e.hash);
}

}  // namespace

std::string format_identification_report(const std::vector<Estimate>& estimates) {
  std::string html = kHead;
  html += "<h1>Identification</h1>\n<p>Red: measured. Green: fitted. Blue: measured less fitted.</p>\n";
  for (const Estimate& e : estimates) html += section(e);
  return html + "</body></html>\n";
}

}  // namespace fjr
