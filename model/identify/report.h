// The paper's figures 3, 4 and 6-14, redrawn from the logs.
#pragma once

#include <string>
#include <vector>

#include "model/identify/agreement.h"
#include "model/identify/estimate.h"

namespace fjr {

// One self-contained HTML page: whether the experiments agree with each other and with the robot known before; then per
// procedure and joint the points with the fit, the residuals, and a table.
std::string format_identification_report(const std::vector<Estimate>& estimates, const std::vector<Change>& changes);

}  // namespace fjr
