// Results for people, on stdout.
#pragma once

#include <string>

#include "planner/certificate/certificate.h"
#include "planner/plan.h"

namespace fjr {

// Returns exactness, feedback, tightest limits and failures of a certificate; every line is indented and ended. limits:
// those it was judged by.
std::string summary(const Certificate& certificate, const Limits& limits);

// Returns outcome, duration, objective, certificate and effort of one plan.
std::string summary(const Problem& problem, const Plan& plan);

}  // namespace fjr
