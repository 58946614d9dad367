#include "planner/results/report/time_charts.h"

#include <algorithm>
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

Series tube_about(const Series& line, const std::string& name, const std::vector<double>& times,
                  const std::vector<double>& half) {
  constexpr std::size_t kMostOfASide = 600;  // an area is not thinned out when it is drawn
  Series tube{name, line.colour, Style::kArea, {}, {}};
  if (times.empty() || half.size() != times.size()) return tube;
  const std::size_t stride = (line.x.size() + kMostOfASide - 1) / kMostOfASide;
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < line.x.size(); i += stride) shown.push_back(i);
  if (shown.back() + 1 != line.x.size()) shown.push_back(line.x.size() - 1);
  const auto add = [&](std::size_t i, double sign) {
    const auto at = std::lower_bound(times.begin(), times.end() - 1, line.x[i]) - times.begin();
    tube.x.push_back(line.x[i]);
    tube.y.push_back(line.y[i] + sign * half[static_cast<std::size_t>(at)]);
  };
  for (const std::size_t i : shown) add(i, 1);
  std::for_each(shown.rbegin(), shown.rend(), [&](std::size_t i) { add(i, -1); });
  return tube;
}

Series both_sides(const std::string& name, const char* colour, double limit, double from, double to) {
  return {name, colour, Style::kDashes, {from, to, NAN, from, to}, {limit, limit, NAN, -limit, -limit}};
}

}  // namespace fjr
