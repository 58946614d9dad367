// The certificate of any trajectory, whoever made it.
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
  Parameters robot;  // and the limits that the verdict is about: those given, made no easier by anything in the file
  Limits limits;
  PlannedWith header;
  std::vector<std::string> contradictions;  // between the file and what was given, one sentence each
  Certificate certificate;
  std::optional<bool> complete;  // all rows are there that the file says that it had; none: it does not say
};

struct VerifyOptions {
  std::optional<Payload> payload;  // none: the robot's, or else the file's
  bool proven = false;             // certified only if everything is proven (planner/certificate/proof), on all cores
  // Certified only if this fraction of the arms that the robot's uncertainty leaves possible keeps everything
  // (planner/certificate/robust), on all cores.
  std::optional<double> robust{};
  PlannedMotion planned{};  // empty where it is not known
};

// source: what it is called in messages. Throws InputError for what the file's header says in another form than
// planned_with() has it.
Verification verify(const Trajectory& trajectory, const std::string& source, const Parameters& robot,
                    const VerifyOptions& options = {});

// The certificate, and what else it is about.
nlohmann::ordered_json verification_json(const Trajectory& trajectory, const Verification& verification);

}  // namespace fjr
