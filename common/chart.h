// Charts as data; chart_page.h draws them.
#pragma once

#include <string>
#include <vector>

namespace fjr {

enum class Style { kDots, kRings, kLine, kThinLine, kDashes, kArea };

// x and y have equal sizes. A point that is not finite interrupts a line. For an area the points run along its edge.
struct Series {
  std::string name, colour;  // colour: as in CSS
  Style style = Style::kDots;
  std::vector<double> x, y;
};

struct Chart {
  std::string title, x_label, y_label;  // labels with units
  std::vector<Series> series;           // the first lies on top
  bool logarithmic_x = false, logarithmic_y = false;
  bool time_axis = false;  // x is a time that charts share: it ends where the data end
};

}  // namespace fjr
