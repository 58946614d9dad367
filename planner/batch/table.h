// One row for every request of a batch: summary.csv and summary.json.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/batch/items.h"

namespace fjr {

using Row = nlohmann::ordered_json;

// Returns the values of plan.json that are worth comparing: name, axes, status, reason, duration [s], objective, terms,
// iterations, intervals, starts, distinct_minima, errors of both rollouts [rad], time [s]. Missing values are null.
Row make_row(const BatchItem& item, const nlohmann::ordered_json& plan);
// Returns the row of a request without a plan.json.
Row make_row(const BatchItem& item, const std::string& status, const std::string& reason);

// The columns of a table of rows: values within `axes` and `terms` are columns of their own, "axes.goal.q[0]".
class Columns {
 public:
  // The columns are in the order that they have in a row. A column that only later rows have is inserted beside its
  // neighbours there.
  void add(const Row& row);
  const std::vector<std::string>& names() const { return names_; }
  // Returns the row's values in these columns; null if it has none.
  std::vector<nlohmann::ordered_json> values(const Row& row) const;

 private:
  std::vector<std::string> names_;
};

// Of these rows.
Columns columns_of(const std::vector<Row>& rows);

// Returns the table as CSV (RFC 4180): the units of the columns as comment lines as in trajectory.csv ("#
// unit.duration: s"), then header and rows. null becomes an empty cell.
std::string table_csv(const std::vector<Row>& rows);

// Returns the units of those columns that have one. Axes have the units of the request's keys.
nlohmann::ordered_json table_units(const Columns& columns);

}  // namespace fjr
