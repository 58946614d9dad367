// The figures of an identification, drawn from its estimates.
#pragma once

#include <vector>

#include "common/chart.h"
#include "model/identify/estimate.h"

namespace fjr {

// Returns the paper's figures as redrawn from the log of this estimate, with the fit, and the residuals. Empty if
// several logs were combined.
std::vector<Chart> charts_of(const Estimate& estimate);

}  // namespace fjr
