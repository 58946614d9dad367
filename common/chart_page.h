// Self-contained HTML pages with charts, which need neither network nor other files.
#pragma once

#include <string>
#include <vector>

#include "common/chart.h"

namespace fjr {

class ChartPage {
 public:
  // title: plain text, like all texts below except for parameters named html.
  explicit ChartPage(const std::string& title);

  void add_html(const std::string& html) { body_ += html; }
  void add_heading(const std::string& text);
  void add_paragraph(const std::string& text, const std::string& css_class = "");
  // The first row is the heading; the first column is text, the others are aligned as numbers.
  void add_table(const std::vector<std::vector<std::string>>& rows);
  void add_style(const std::string& css) { style_ += css; }
  // Runs when the charts are drawn; finds them in `drawn`, an array of Chart.js charts in the order they were added.
  void add_script(const std::string& javascript) { script_ += javascript; }
  // JSON for scripts: JSON.parse(document.getElementById(id).textContent).
  void add_data(const std::string& id, const std::string& json);
  // Adds charts side by side if there is room.
  void add_charts(const std::vector<Chart>& charts);

  std::string html() const;

 private:
  std::string title_, style_, body_, charts_, script_;  // charts_: JSON, one object a line
  std::size_t count_ = 0;
};

std::string escaped_html(const std::string& text);

extern const char* const kChartJs;  // the library's own text, MIT licence

}  // namespace fjr
