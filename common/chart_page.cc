#include "common/chart_page.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace fjr {
namespace {

constexpr std::size_t kMostPoints = 1500;  // drawn of a series: more cannot be told apart

constexpr const char* kStyle = R"(
body { font: 16px/1.5 system-ui, sans-serif; max-width: 1240px; margin: 0 auto; padding: 1rem; color: #222; background: #fff; }
h1 { font-size: 1.6rem; margin: 0.5rem 0; } h2 { font-size: 1.2rem; margin: 2rem 0 0.5rem; border-top: 1px solid #ddd; padding-top: 1rem; }
p { margin: 0.4rem 0; } .note { color: #555; font-size: 0.85rem; overflow-wrap: anywhere; } .warning { color: #a33b00; }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 360px), 1fr)); gap: 1rem; margin: 0.5rem 0; }
figure { margin: 0; min-width: 0; } figcaption { font-weight: 600; font-size: 0.9rem; }
.chart { position: relative; height: 320px; }
.table { overflow-x: auto; } table { border-collapse: collapse; font-size: 0.9rem; }
th, td { padding: 0.2rem 0.8rem 0.2rem 0; text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
th:first-child, td:first-child { text-align: left; } th { border-bottom: 1px solid #bbb; } td { border-bottom: 1px solid #eee; }
@media (max-width: 480px) { body { font-size: 15px; padding: 0.7rem; } .chart { height: 290px; } }
@media print { .chart { break-inside: avoid; } }
)";

// Draws `charts`, which stands before it.
constexpr const char* kScript = R"(
const isLine = s => ["line", "thin line", "dashes"].includes(s.style);
Chart.defaults.font.family = "system-ui, sans-serif";
Chart.defaults.color = "#444";
const isPower = v => Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-9;
const power = v => !isPower(v) ? "" : v > 0.005 && v < 500 ? String(+v.toPrecision(1)) : v.toExponential(0);
const short = v => String(+v.toPrecision(4));
const axis = (text, logarithmic) => ({
  type: logarithmic ? "logarithmic" : "linear",
  title: { display: true, text },
  grid: { color: "#e8e8e8" },
  ticks: { callback: logarithmic ? power : short, maxTicksLimit: logarithmic ? 30 : 7, maxRotation: 0 },
});
const timeTicks = scale => {  // at most six, 1, 2 or 5 times a power of ten apart
  const least = (scale.max - scale.min) / 6, ten = 10 ** Math.floor(Math.log10(least));
  const step = ten * [1, 2, 5, 10].find(factor => factor * ten >= least * 0.999);
  const first = Math.ceil(scale.min / step - 1e-9), last = Math.floor(scale.max / step + 1e-9);
  scale.ticks = Array.from({ length: last - first + 1 }, (_, i) => ({ value: (first + i) * step }));
};
const timeAxis = text => ({ ...axis(text, false), bounds: "data", afterBuildTicks: timeTicks });
const dataset = s => ({
  label: s.name,
  data: s.points,
  borderColor: s.colour,
  backgroundColor: s.style === "rings" ? "transparent" : s.colour,
  borderWidth: s.style === "dots" ? 0 : s.style === "line" || s.style === "rings" ? 1.5 : 1,
  borderDash: s.style === "dashes" ? [5, 4] : [],
  showLine: isLine(s),
  pointRadius: isLine(s) ? 0 : s.style === "rings" ? 3 : 1.7,
  pointStyle: isLine(s) ? "line" : "circle",
});
const drawn = charts.map((c, i) => new Chart(document.getElementById("chart" + i), {
  type: "scatter",
  data: { datasets: c.series.map(dataset) },
  options: {
    animation: false, maintainAspectRatio: false, locale: "en-US",
    plugins: { legend: { display: c.series.length > 1, position: "bottom",
                         labels: { usePointStyle: true, boxWidth: 7, boxHeight: 7, padding: 10 } } },
    scales: { x: c.time_axis ? timeAxis(c.x_label) : axis(c.x_label, c.logarithmic_x),
              y: axis(c.y_label, c.logarithmic_y) },
  },
}));
)";

const char* name_of(Style style) {
  switch (style) {
    case Style::kDots:
      return "dots";
    case Style::kRings:
      return "rings";
    case Style::kLine:
      return "line";
    case Style::kThinLine:
      return "thin line";
    case Style::kDashes:
      return "dashes";
  }
  return "";
}

// Seven digits are more than a screen shows.
double short_number(double value) { return std::stod(fmt::format("{:.7g}", value)); }

// JSON without `</script>` or `<!--` in its strings, where alone `<` can be.
std::string within_script(std::string json) {
  for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;) json.replace(at, 1, "\\u003c");
  return json;
}

nlohmann::ordered_json json_of(const Series& s) {
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  const std::size_t stride = (s.x.size() + kMostPoints - 1) / kMostPoints;
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i])) {
      points.push_back({{"x", nullptr}, {"y", nullptr}});
    } else if (i % stride == 0) {
      points.push_back({{"x", short_number(s.x[i])}, {"y", short_number(s.y[i])}});
    }
  }
  return {{"name", s.name}, {"colour", s.colour}, {"style", name_of(s.style)}, {"points", points}};
}

std::string json_text(const Chart& chart) {
  nlohmann::ordered_json json{{"x_label", chart.x_label},
                              {"y_label", chart.y_label},
                              {"logarithmic_x", chart.logarithmic_x},
                              {"logarithmic_y", chart.logarithmic_y},
                              {"time_axis", chart.time_axis},
                              {"series", nlohmann::ordered_json::array()}};
  for (const Series& s : chart.series) json["series"].push_back(json_of(s));
  return within_script(json.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace));
}

}  // namespace

std::string escaped_html(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '&':
        result += "&amp;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

ChartPage::ChartPage(const std::string& title) : title_(title) {
  body_ = "<h1>" + escaped_html(title) +
          "</h1>\n<noscript><p class='warning'>The charts need JavaScript, which is in "
          "this file.</p></noscript>\n";
}

void ChartPage::add_heading(const std::string& text) { body_ += "<h2>" + escaped_html(text) + "</h2>\n"; }

void ChartPage::add_paragraph(const std::string& text, const std::string& css_class) {
  body_ += fmt::format("<p class='{}'>{}</p>\n", css_class, escaped_html(text));
}

void ChartPage::add_table(const std::vector<std::vector<std::string>>& rows) {
  body_ += "<div class='table'><table>\n";
  for (std::size_t row = 0; row < rows.size(); ++row) {
    body_ += "<tr>";
    for (const std::string& cell : rows[row]) {
      body_ += fmt::format("<{0}>{1}</{0}>", row == 0 ? "th" : "td", escaped_html(cell));
    }
    body_ += "</tr>\n";
  }
  body_ += "</table></div>\n";
}

void ChartPage::add_data(const std::string& id, const std::string& json) {
  body_ += fmt::format("<script type='application/json' id='{}'>{}</script>\n", id, within_script(json));
}

void ChartPage::add_charts(const std::vector<Chart>& charts) {
  body_ += "<div class='charts'>\n";
  for (const Chart& chart : charts) {
    const std::string title = escaped_html(chart.title);
    body_ += fmt::format(
        "<figure><figcaption>{0}</figcaption><div class='chart'><canvas id='chart{1}' role='img' aria-label=\"{0}\">"
        "</canvas></div></figure>\n",
        title, count_++);
    charts_ += json_text(chart) + ",\n";
  }
  body_ += "</div>\n";
}

std::string ChartPage::html() const {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{}</title>\n<style>{}{}</style></head><body>\n{}<script>{}</script>\n"
      "<script>const charts = [\n{}];\n{}{}</script>\n</body></html>\n",
      escaped_html(title_), kStyle, style_, body_, kChartJs, charts_, kScript, script_);
}

}  // namespace fjr
