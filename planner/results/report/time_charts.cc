#include "planner/results/report/time_charts.h"

#include <cmath>

namespace fjr {

Series series_of(const std::string& name, const char* colour, const std::vector<Sample>& samples, Quantity quantity,
                 std::size_t joint, Style style) {
  Series series{name, colour, style, {}, {}};
  for (const Sample& sample : samples) {
    series.x.push_back(sample.time);
    series.y.push_back(quantity(sample, joint));
  }
  return series;
}

Chart time_chart(const std::string& title, const std::string& unit) {
  Chart chart{title, "time (s)", unit, {}};
  chart.time_axis = true;
  return chart;
}

Series both_sides(const std::string& name, const char* colour, double limit, double from, double to) {
  return {name, colour, Style::kDashes, {from, to, NAN, from, to}, {limit, limit, NAN, -limit, -limit}};
}

}  // namespace fjr
