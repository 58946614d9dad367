// Charts of trajectories over the time that they share.
#pragma once

#include <string>
#include <vector>

#include "common/chart_page.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

inline constexpr Joints<const char*> kJointColour{"#1f77b4", "#d9660f"}, kMotorColour{"#8cbbdc", "#f2b183"};

using Quantity = double (*)(const Sample& sample, std::size_t joint);

Chart time_chart(const std::string& title, const std::string& unit);
Series series_of(const std::string& name, const char* colour, const std::vector<Sample>& samples, Quantity quantity,
                 std::size_t joint, Style style = Style::kLine);

// Returns the area within half widths of a line. half[i] holds from times[i-1] to times[i]. Returns an empty series if
// there are none.
Series tube_about(const Series& line, const std::string& name, const std::vector<double>& times,
                  const std::vector<double>& half);

// Returns a limit on a magnitude as dashed lines on both sides.
Series both_sides(const std::string& name, const char* colour, double limit, double from, double to);

}  // namespace fjr
