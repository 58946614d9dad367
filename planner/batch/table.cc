#include "planner/batch/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "planner/problem/objective_terms.h"
#include "planner/request/keys.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kAxis = "axes.";

// The value at a path such as /solver/iterations, null if there is none.
Json value_at(const Json& plan, const char* path) { return plan.value(Json::json_pointer(path), Json()); }

std::vector<std::pair<std::string, Json>> cells(const Row& row) {
  std::vector<std::pair<std::string, Json>> cells;
  for (const auto& [key, value] : row.items()) {
    if (!value.is_object()) {
      cells.emplace_back(key, value);
      continue;
    }
    for (const auto& [inner, part] : value.items()) cells.emplace_back(key + "." + inner, part);
  }
  return cells;
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n#") == std::string::npos) return text;  // '#' would begin a comment
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

std::string csv_text(const Json& value) {
  if (value.is_null()) return "";
  return quoted(value.is_string() ? value.get<std::string>()
                                  : value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::string csv_line(const std::vector<std::string>& fields) { return fmt::format("{}\n", fmt::join(fields, ",")); }

}  // namespace

Row make_row(const BatchItem& item, const Json& plan) {
  return {{"name", item.name},
          {"axes", item.axes.is_null() ? Json::object() : item.axes},
          {"status", value_at(plan, "/status")},
          {"reason", value_at(plan, "/reason")},
          {"duration", value_at(plan, "/duration")},
          {"objective", value_at(plan, "/objective/total")},
          {"terms", plan.value("/objective/terms"_json_pointer, Json::object())},
          {"iterations", value_at(plan, "/solver/iterations")},
          {"intervals", value_at(plan, "/mesh/intervals")},
          {"starts", value_at(plan, "/solver/starts")},
          {"distinct_minima", value_at(plan, "/solver/distinct_minima")},
          {"open_loop_error", value_at(plan, "/certificate/open_loop/max_link_error_rad")},
          {"closed_loop_error", value_at(plan, "/certificate/closed_loop/max_link_error_rad")},
          {"time", value_at(plan, "/timing/total")}};
}

Row make_row(const BatchItem& item, const std::string& status, const std::string& reason) {
  return make_row(item, Json{{"status", status}, {"reason", reason}});
}

void Columns::add(const Row& row) {
  auto after = names_.begin();
  for (const auto& [column, value] : cells(row)) {
    const auto found = std::find(names_.begin(), names_.end(), column);
    after = (found != names_.end() ? found : names_.insert(after, column)) + 1;
  }
}

std::vector<Json> Columns::values(const Row& row) const {
  std::vector<Json> values(names_.size());
  for (auto& [column, value] : cells(row)) {
    const auto at = static_cast<std::size_t>(std::find(names_.begin(), names_.end(), column) - names_.begin());
    if (at < values.size()) values[at] = std::move(value);
  }
  return values;
}

Columns columns_of(const std::vector<Row>& rows) {
  Columns columns;
  for (const Row& row : rows) columns.add(row);
  return columns;
}

std::string table_csv(const std::vector<Row>& rows) {
  const Columns table = columns_of(rows);
  std::vector<std::string> header;
  for (const std::string& column : table.names()) header.push_back(quoted(column));
  std::string text;
  const Json units = table_units(table);
  for (const auto& [column, unit] : units.items()) {
    text += fmt::format("# unit.{}: {}\n", column, unit.get<std::string>());
  }
  text += csv_line(header);
  for (const Row& row : rows) {
    std::vector<std::string> fields;
    for (const Json& value : table.values(row)) fields.push_back(csv_text(value));
    text += csv_line(fields);
  }
  return text;
}

Json table_units(const Columns& columns) {
  std::map<std::string, std::string> known{
      {"duration", "s"}, {"open_loop_error", "rad"}, {"closed_loop_error", "rad"}, {"time", "s"}};
  for (const TermInfo& term : Terms::infos) known["terms." + std::string(term.name)] = term.unit;
  Json units = Json::object();
  for (const std::string& column : columns.names()) {
    const std::string unit = column.starts_with(kAxis) ? unit_of_key(column.substr(kAxis.size())) : known[column];
    if (!unit.empty()) units[column] = unit;
  }
  return units;
}

}  // namespace fjr
