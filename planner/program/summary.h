// Results for people, on stdout.
#pragma once

#include <string>

#include "planner/certificate/certificate.h"
#include "planner/plan.h"

namespace fjr {

// Exactness, feedback, tightest limits and what failed; every line indented and ended. limits: that it was judged by.
std::string summary(const Certificate& certificate, const Limits& limits);

// Outcome, duration, objective, certificate and effort of one plan.
std::string summary(const Problem& problem, const Plan& plan);

}  // namespace fjr
