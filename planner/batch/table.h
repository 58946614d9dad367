// One row for every request of a batch: summary.csv and summary.json.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/batch/items.h"

namespace fjr {

using Row = nlohmann::ordered_json;

// What plan.json says that is worth comparing: name, axes, status, reason, duration [s], objective, terms, iterations,
// intervals, starts, distinct_minima, errors of both rollouts [rad], time [s]. null where there is nothing to say.
Row make_row(const BatchItem& item, const nlohmann::ordered_json& plan);
// For a request without a plan.json.
Row make_row(const BatchItem& item, const std::string& status, const std::string& reason);

// The columns of a table of rows: values within `axes` and `terms` are columns of their own, "axes.goal.q[0]".
class Columns {
 public:
  // In a row's own order; what only later rows have stands with its neighbours there.
  void add(const Row& row);
  const std::vector<std::string>& names() const { return names_; }
  // The row's values in these columns; null where it has none.
  std::vector<nlohmann::ordered_json> values(const Row& row) const;

 private:
  std::vector<std::string> names_;
};

// Of these rows.
Columns columns_of(const std::vector<Row>& rows);

// The units of the columns as comment lines, as in trajectory.csv ("# unit.duration: s"), then header and rows. RFC
// 4180; null is empty.
std::string table_csv(const std::vector<Row>& rows);

// Column -> unit, of those of the table that have one. Axes have the units of the request's keys.
nlohmann::ordered_json table_units(const Columns& columns);

}  // namespace fjr
