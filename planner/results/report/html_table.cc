#include "planner/results/report/html_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/chart_page.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDeepest = 4;                              // nesting shown as tables; below it as JSON
constexpr std::size_t kLongText = 40;                    // of a cell: is wrapped
constexpr std::size_t kMostItems = 200, kUnfolded = 12;  // of a list: shown, shown at once

bool is_short_list(const Json& json, std::size_t most) {
  return json.is_array() && json.size() <= most &&
         std::all_of(json.begin(), json.end(), [](const Json& item) { return item.is_primitive(); });
}

// Returns whether a value fits into a cell: a single value, a few, or a list of pairs.
bool is_plain(const Json& json) {
  if (json.is_primitive() || is_short_list(json, 8)) return true;
  return json.is_array() && json.size() <= 16 &&
         std::all_of(json.begin(), json.end(), [](const Json& item) { return is_short_list(item, 3); });
}

std::string plain_text(const Json& json) {
  if (json.is_null()) return "-";
  if (json.is_string()) return json.get<std::string>();
  if (json.is_number_float()) return number_text(json.get<double>(), 6);
  if (!json.is_array()) return json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string text;
  for (const Json& item : json) {
    if (!text.empty()) text += ", ";
    text += item.is_array() ? fmt::format("({})", plain_text(item)) : plain_text(item);
  }
  return text;
}

Cell plain_cell(const Json& json) {
  std::string text = plain_text(json);
  const bool pairs = json.is_array() && !json.empty() && json.front().is_array();
  const char* const css = pairs || text.size() > kLongText ? "long" : "";
  return cell(std::move(text), css);
}

bool is_list_of_alike(const Json& json) {
  return json.is_array() && !json.empty() && std::all_of(json.begin(), json.end(), [](const Json& item) {
           return item.is_object() && std::all_of(item.begin(), item.end(), is_plain);
         });
}

std::string table_of_alike(const Json& list) {
  Rows rows(1);
  for (const auto& item : list.front().items()) rows[0].push_back(cell(spaced(item.key())));
  for (std::size_t i = 0; i < std::min(list.size(), kMostItems); ++i) {
    std::vector<Cell> row;
    for (const auto& item : list.front().items()) {
      row.push_back(list[i].contains(item.key()) ? plain_cell(list[i][item.key()]) : cell(""));
    }
    rows.push_back(std::move(row));
  }
  return html_table(rows);
}

std::string table_of_numbers(const Json& list) {
  Rows rows;
  for (std::size_t i = 0; i < std::min(list.size(), kMostItems); ++i) {
    rows.push_back({cell(std::to_string(i)), plain_cell(list[i])});
  }
  return html_table(rows, false);
}

// Wraps long lists so that they are collapsed at first.
std::string folded(const Json& list, const std::string& table) {
  if (list.size() <= kUnfolded) return table;
  const std::string count = list.size() <= kMostItems ? fmt::format("{} entries", list.size())
                                                      : fmt::format("{} of {} entries", kMostItems, list.size());
  return "<details><summary>" + count + "</summary>" + table + "</details>\n";
}

std::string html_at_depth(const Json& json, int depth) {
  if (is_plain(json)) return "<p>" + escaped_html(plain_text(json)) + "</p>\n";
  if (depth >= kDeepest) {
    return "<pre>" + escaped_html(json.dump(2, ' ', false, Json::error_handler_t::replace)) + "</pre>\n";
  }
  if (is_list_of_alike(json)) return folded(json, table_of_alike(json));
  if (json.is_array() && std::all_of(json.begin(), json.end(), is_plain)) return folded(json, table_of_numbers(json));
  Rows rows;
  std::string below;
  for (const auto& item : json.items()) {
    if (is_plain(item.value())) {
      rows.push_back({cell(spaced(item.key())), plain_cell(item.value())});
    } else {
      below += "<h3>" + escaped_html(spaced(item.key())) + "</h3>\n" + html_at_depth(item.value(), depth + 1);
    }
  }
  return (rows.empty() ? "" : html_table(rows, false)) + below;
}

}  // namespace

Cell cell(std::string text, std::string css_class) { return {std::move(text), std::move(css_class), ""}; }
Cell html_cell(std::string html) { return {"", "", std::move(html)}; }

std::string number_text(double value, int digits) {
  return std::isnan(value) ? "-" : std::isinf(value) ? "none" : fmt::format("{:.{}g}", value, digits);
}

std::string spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string html_table(const Rows& rows, bool heading) {
  std::string html = "<div class='table' tabindex='0'><table>\n";  // a keyboard scrolls it too
  for (std::size_t row = 0; row < rows.size(); ++row) {
    html += "<tr>";
    for (const Cell& cell : rows[row]) {
      const std::string css = cell.css_class.empty() ? "" : fmt::format(" class='{}'", cell.css_class);
      html += fmt::format("<{0}{1}>{2}</{0}>", heading && row == 0 ? "th" : "td", css,
                          cell.html.empty() ? escaped_html(cell.text) : cell.html);
    }
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

std::string html_of_json(const Json& json) { return html_at_depth(json, 0); }

}  // namespace fjr
