// Plans and logs as tables whose column names contain the unit, from which all exports are made.
#pragma once

#include <string>
#include <vector>

#include "model/log.h"
#include "planner/results/report/plan_record.h"

namespace fjr {

struct ExportTable {
  std::vector<std::string> names;           // "time_s", "q1_rad", ...
  std::vector<std::vector<double>> values;  // values[i] belongs to names[i]; equally long

  std::size_t rows() const { return values.empty() ? 0 : values.front().size(); }
  void add(std::string name, std::vector<double> column);
  const std::vector<double>& column(const std::string& name) const;  // the column must exist
};

// A trajectory at the ticks of a drive; row k is at k ticks. `tau1_mean_N_m` and `tau2_mean_N_m` are the means of the
// planned torque over the tick that begins there. A drive that holds one value per tick must be commanded these.
struct Ticked {
  double tick = 0;           // [s]
  std::vector<Sample> rows;  // the last one is the first at or beyond the end of a motion that ends at rest
  std::vector<Joints<double>> mean_torque;
};
Ticked at_ticks(const Parameters& robot, const Trajectory& trajectory, double tick);

// time, q, dq, theta, dtheta, tau, mean tau, tip position and speed.
ExportTable table_of(const Parameters& robot, const Ticked& ticked);

// Returns the columns of the log as they were recorded.
ExportTable table_of(const Log& log);

}  // namespace fjr
