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

// With a heading, that is the first row.
std::string html_table(const std::vector<std::vector<Cell>>& rows, bool heading = true);

// Objects and lists of any shape: numbers and texts in one table, whatever is nested below under its name.
std::string html_of_json(const nlohmann::ordered_json& json);

// "torque_rate" -> "torque rate"
std::string spaced(std::string name);

}  // namespace fjr
