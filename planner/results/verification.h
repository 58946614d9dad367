// Certifies trajectories from any source.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/certificate/certificate.h"
#include "planner/results/planned_motion.h"
#include "planner/results/planned_with.h"

namespace fjr {

struct Verification {
  Parameters robot;  // of the verdict: the given one, with the plan's payload if nothing else says one
  Limits limits;     // of the verdict: the robot's, which plan.json and the file's header can only make stricter
  PlannedWith header;
  std::vector<std::string> contradictions;  // between the file and what was given, one sentence each
  Certificate certificate;
  std::optional<bool> complete;  // whether no rows are missing; empty if the file does not say how many there were
};

struct VerifyOptions {
  std::optional<Payload> payload;  // empty: the robot's, or else the file's
  bool proven = false;             // certify only what is proven (planner/certificate/proof); uses all cores
  // Certify only if this fraction of the arms that the robot's uncertainty admits keeps all limits and the task
  // (planner/certificate/robust); uses all cores.
  std::optional<double> robust{};
  PlannedMotion planned{};  // empty if it is not known
};

// Returns the options under which a trajectory is certified only if it does what a request asks, in its robot, with
// what the request wants proven and robust. of_plan: as in requested_motion(), which also says what is thrown.
VerifyOptions as_asked_by(const Problem& request, PlannedMotion of_plan, const Trajectory& trajectory);

// source: name of the trajectory in messages. Throws InputError if its header does not have the form of planned_with().
Verification verify(const Trajectory& trajectory, const std::string& source, const Parameters& robot,
                    const VerifyOptions& options = {});

// Returns the certificate and the conditions it refers to.
nlohmann::ordered_json verification_json(const Trajectory& trajectory, const Verification& verification);

}  // namespace fjr
