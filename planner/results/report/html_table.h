// Tables whose cells may stand out, and JSON shown as tables.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace fjr {

struct Cell {
  std::string text;       // plain
  std::string css_class;  // "" or one of the page's
  std::string html;       // instead of text
};

Cell cell(std::string text, std::string css_class = "");
Cell html_cell(std::string html);
using Rows = std::vector<std::vector<Cell>>;

// heading: whether the first row is one.
std::string html_table(const Rows& rows, bool heading = true);

// Shows JSON of any structure: numbers and texts in one table, nested objects and lists below it under their names.
std::string html_of_json(const nlohmann::ordered_json& json);

// Returns "-" for NaN (also from null), and "none" for infinity.
std::string number_text(double value, int digits = 4);

// "torque_rate" -> "torque rate"
std::string spaced(std::string name);

}  // namespace fjr
