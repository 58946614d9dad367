#include "common/chart_page.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/rounded.h"

namespace fjr {
namespace {

constexpr std::size_t kMostPoints = 1500;  // drawn of a series: more cannot be told apart

// Colours are variables, so that whatever is on a page follows the reader's choice of light or dark. Tables that are
// wider than the page show a shadow where they go on.
constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --paper: #fff; --text: #222; --soft: #555; --line: #bbb; --rule: #ddd; --faint: #eee; --grid: #e8e8e8;
  --alert: #a33b00; --over: #b00020; --link: #1f5fa8; --button: #f7f7f7; --shadow: #0005; }
@media (prefers-color-scheme: dark) { :root { --paper: #17191c; --text: #e4e4e4; --soft: #aaa; --line: #666; --rule: #3a3d42; --faint: #2b2e33;
  --grid: #303338; --alert: #f0a070; --over: #ff7b8a; --link: #7db4ee; --button: #26292e; --shadow: #000c; } }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 1240px; margin: 0 auto; padding: 1rem; color: var(--text); background: var(--paper); }
h1 { font-size: 1.6rem; margin: 0.5rem 0; overflow-wrap: anywhere; }
h2 { font-size: 1.2rem; margin: 2rem 0 0.5rem; border-top: 1px solid var(--rule); padding-top: 1rem; }
p { margin: 0.4rem 0; } .note { color: var(--soft); font-size: 0.85rem; overflow-wrap: anywhere; } .warning { color: var(--alert); overflow-wrap: anywhere; }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 360px), 1fr)); gap: 1rem; margin: 0.5rem 0; }
figure { margin: 0; min-width: 0; } figcaption { font-weight: 600; font-size: 0.9rem; display: flex; gap: 0.5rem; align-items: baseline; }
figcaption button { margin-left: auto; font-size: 0.7rem; padding: 0 0.35rem; color: var(--soft); cursor: pointer; }
button, select { font: inherit; font-size: 0.9rem; padding: 0.15rem 0.6rem; border: 1px solid var(--line); border-radius: 0.3rem;
  background: var(--button); color: var(--text); }
.chart { position: relative; height: 320px; }
.table { overflow-x: auto; width: fit-content; max-width: 100%; scrollbar-width: thin;
  background: linear-gradient(90deg, var(--paper) 30%, transparent) left / 2.5rem 100% no-repeat local,
    linear-gradient(270deg, var(--paper) 30%, transparent) right / 2.5rem 100% no-repeat local,
    linear-gradient(90deg, var(--shadow), transparent) left / 0.8rem 100% no-repeat scroll,
    linear-gradient(270deg, var(--shadow), transparent) right / 0.8rem 100% no-repeat scroll; }
table { border-collapse: collapse; font-size: 0.9rem; }
th, td { padding: 0.2rem 0.8rem 0.2rem 0; text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
th:first-child, td:first-child { text-align: left; } th { border-bottom: 1px solid var(--line); } td { border-bottom: 1px solid var(--faint); }
@media (max-width: 480px) { body { font-size: 15px; padding: 0.7rem; } .chart { height: 290px; } }
@media print { .chart { break-inside: avoid; } figcaption button { display: none; } }
)";

// Draws `charts`, which stands before it.
constexpr const char* kScript = R"js(
const isLine = s => ["line", "thin line", "dashes", "area"].includes(s.style);
Chart.defaults.font.family = "system-ui, sans-serif";
const ink = name => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
const atNight = matchMedia("(prefers-color-scheme: dark)");
const shade = colour => atNight.matches ? { "#111111": "#eee", "#333": "#ccc", "#555": "#aaa" }[colour] || colour : colour;
Chart.defaults.color = ink("soft");
const isPower = v => Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-9;
const power = v => !isPower(v) ? "" : v > 0.005 && v < 500 ? String(+v.toPrecision(1)) : v.toExponential(0);
const short = v => String(+v.toPrecision(4));
const axis = (text, logarithmic) => ({
  type: logarithmic ? "logarithmic" : "linear",
  title: { display: true, text },
  grid: { color: ink("grid") },
  ticks: { callback: logarithmic ? power : short, maxTicksLimit: logarithmic ? 30 : 7, maxRotation: 0 },
});
const timeTicks = scale => {  // at most six, 1, 2 or 5 times a power of ten apart
  const least = (scale.max - scale.min) / 6, ten = 10 ** Math.floor(Math.log10(least));
  const step = ten * [1, 2, 5, 10].find(factor => factor * ten >= least * 0.999);
  const first = Math.ceil(scale.min / step - 1e-9), last = Math.floor(scale.max / step + 1e-9);
  scale.ticks = Array.from({ length: last - first + 1 }, (_, i) => ({ value: (first + i) * step }));
};
const timeAxis = text => ({ ...axis(text, false), bounds: "data", afterBuildTicks: timeTicks });
const areaOpacity = 0.3;
const filled = s => s.style === "rings" ? "transparent"
  : s.style === "area" ? shade(s.colour) + Math.round(255 * areaOpacity).toString(16) : shade(s.colour);
const dataset = s => ({
  label: s.name,
  data: s.points,
  borderColor: shade(s.colour),
  backgroundColor: filled(s),
  fill: s.style === "area" ? "shape" : false,
  borderWidth: s.style === "dots" ? 0 : s.style === "line" || s.style === "rings" ? 1.5 : s.style === "area" ? 0.5 : 1,
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
atNight.addEventListener("change", () => drawn.forEach((chart, i) => {
  Chart.defaults.color = ink("soft");
  chart.data.datasets.forEach((set, k) => {
    set.borderColor = shade(charts[i].series[k].colour);
    set.backgroundColor = filled(charts[i].series[k]);
  });
  for (const scale of Object.values(chart.options.scales)) {
    scale.grid.color = ink("grid");
    scale.ticks.color = scale.title.color = ink("soft");
  }
  if (chart.options.plugins.legend.labels) chart.options.plugins.legend.labels.color = ink("soft");
  chart.update();
}));

// ---- a chart as SVG, as it is on the page, on white ----
const xml = text => String(text).replace(/[&<>"]/g, c => `&#${c.charCodeAt(0)};`);
const rounded = v => Math.round(10 * v) / 10;
function pathOf(chart, dataset) {  // in pixels; interrupted where a point is not finite
  const { x, y } = chart.scales;
  let path = "", pen = "M";
  for (const point of dataset.data) {
    if (point.x === null || point.y === null) { pen = "M"; continue; }
    path += pen + rounded(x.getPixelForValue(point.x)) + " " + rounded(y.getPixelForValue(point.y));
    pen = "L";
  }
  return path;
}
// SVG's namespace as the browser knows it: no address stands on the page.
const svgNamespace = new DOMParser().parseFromString("<svg></svg>", "text/html").body.firstChild.namespaceURI;
function svgOf(chart, about, title) {
  const { left, right, top, bottom } = chart.chartArea, { x, y } = chart.scales, head = 22, legend = 22;
  const text = (px, py, words, more = "") => `<text x="${rounded(px)}" y="${rounded(py)}" ${more}>${xml(words)}</text>`;
  const middle = 'text-anchor="middle"', parts = [];
  for (const tick of x.ticks) {
    const px = rounded(x.getPixelForValue(tick.value));
    parts.push(`<path d="M${px} ${top}V${bottom}" stroke="#e8e8e8"/>`, text(px, bottom + 14, tick.label ?? "", middle));
  }
  for (const tick of y.ticks) {
    const py = rounded(y.getPixelForValue(tick.value));
    parts.push(`<path d="M${left} ${py}H${right}" stroke="#e8e8e8"/>`, text(left - 6, py + 4, tick.label ?? "", 'text-anchor="end"'));
  }
  parts.push(text((left + right) / 2, bottom + 32, about.x_label, middle));
  const across = (top + bottom) / 2;
  parts.push(text(12, across, about.y_label, `${middle} transform="rotate(-90 12 ${across})"`));
  const box = [left - 1, top - 1, right - left + 2, bottom - top + 2];  // an SVG in the SVG, which cuts off what is outside
  parts.push(`<svg x="${box[0]}" y="${box[1]}" width="${box[2]}" height="${box[3]}" viewBox="${box.join(" ")}">`);
  const shown = chart.data.datasets.map((set, i) => [set, about.series[i], chart.isDatasetVisible(i)]).filter(entry => entry[2]);
  for (const [set, series] of [...shown].reverse()) {
    if (isLine(series)) {
      const fill = series.style === "area" ? `fill="${xml(series.colour)}" fill-opacity="${areaOpacity}"` : 'fill="none"';
      parts.push(`<path class="line" d="${pathOf(chart, set)}" ${fill} stroke="${xml(series.colour)}" ` +
        `stroke-width="${set.borderWidth}" stroke-dasharray="${set.borderDash.join(" ")}"/>`);
    } else {
      const fill = series.style === "rings" ? "none" : xml(series.colour);
      for (const point of set.data.filter(point => point.x !== null && point.y !== null)) {
        parts.push(`<circle cx="${rounded(x.getPixelForValue(point.x))}" cy="${rounded(y.getPixelForValue(point.y))}" ` +
          `r="${set.pointRadius}" fill="${fill}" stroke="${xml(series.colour)}"/>`);
      }
    }
  }
  parts.push("</svg>");
  let along = left;
  for (const [, series] of shown.length > 1 ? shown : []) {
    parts.push(`<path d="M${rounded(along)} ${bottom + 46}h12" stroke="${xml(series.colour)}" stroke-width="2"/>`,
      text(along + 16, bottom + 50, series.name));
    along += 26 + 6.5 * series.name.length;
  }
  const width = Math.max(chart.width, along), height = bottom + head + 36 + legend;
  return `<svg xmlns="${svgNamespace}" viewBox="0 0 ${rounded(width)} ${rounded(height)}" width="${rounded(width)}" ` +
    `font-family="sans-serif" font-size="12" fill="#333"><rect width="100%" height="100%" fill="#fff"/>` +
    text(left, 15, title, 'font-weight="bold"') + `<g transform="translate(0 ${head})">${parts.join("")}</g></svg>`;
}
function saveSvg(button) {
  const i = Number(button.dataset.chart), title = button.previousElementSibling.textContent;
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([svgOf(drawn[i], charts[i], title)], { type: "image/svg+xml" }));
  link.download = title.toLowerCase().replace(/[^a-z0-9]+/g, "_").replace(/^_|_$/g, "") + ".svg";
  link.click();
  URL.revokeObjectURL(link.href);
}
for (const button of document.querySelectorAll("button.svg")) button.addEventListener("click", () => saveSvg(button));
)js";

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
    case Style::kArea:
      return "area";
  }
  return "";
}

// Seven digits are more than a screen shows.
double short_number(double value) { return rounded_to(value, 7); }

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
  body_ += "<div class='table' tabindex='0'><table>\n";
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
        "<figure><figcaption><span>{0}</span><button class='svg' type='button' data-chart='{1}' title='Save as SVG'>SVG"
        "</button></figcaption><div class='chart'><canvas id='chart{1}' role='img' aria-label=\"{0}\">"
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
