// HTML pages with charts that need nothing but themselves: no network, no other file.
#pragma once

#include <string>
#include <vector>

namespace fjr {

enum class Style { kDots, kRings, kLine };

// Equally many x and y; a point that is not finite interrupts a line.
struct Series {
  std::string name, colour;  // colour: as in CSS
  Style style = Style::kDots;
  std::vector<double> x, y;
};

struct Chart {
  std::string title, x_label, y_label;  // labels with units
  std::vector<Series> series;           // the first lies on top
  bool logarithmic_x = false;
};

class ChartPage {
 public:
  // title: plain text, as all texts below, unless they are called html.
  explicit ChartPage(const std::string& title);

  void add_html(const std::string& html) { body_ += html; }
  void add_heading(const std::string& text);
  void add_paragraph(const std::string& text, const std::string& css_class = "");
  // The first row is the heading; the first column is text, the others are aligned as numbers.
  void add_table(const std::vector<std::vector<std::string>>& rows);
  // Side by side where there is room.
  void add_charts(const std::vector<Chart>& charts);

  std::string html() const;

 private:
  std::string title_, body_, charts_;  // charts_: JSON, one object a line
  std::size_t count_ = 0;
};

std::string escaped_html(const std::string& text);

extern const char* const kChartJs;  // the library's own text, MIT licence

}  // namespace fjr
