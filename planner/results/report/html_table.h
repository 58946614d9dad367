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

// With a heading, that is the first row.
std::string html_table(const Rows& rows, bool heading = true);

// Objects and lists of any shape: numbers and texts in one table, whatever is nested below under its name.
std::string html_of_json(const nlohmann::ordered_json& json);

// "-" for what is not a number, as null is; "none" for what is infinite.
std::string number_text(double value, int digits = 4);

// "torque_rate" -> "torque rate"
std::string spaced(std::string name);

}  // namespace fjr
