// The certificate of any trajectory, whoever made it.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/certificate/certificate.h"
#include "planner/problem/problem.h"
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

// What plan.json says that the motion was asked for.
struct PlannedMotion {
  Task task;
  std::vector<double> ends;               // [s] of the motion's segments
  Limits limits = Limits::all(kNoLimit);  // those that are tighter than the robot's that it was planned for
  std::optional<State<double>> start{};   // none: not said
  std::vector<Goal> goals{};              // any of them will do; empty: not said
  Duration duration{0, kNoLimit};         // [s]
  std::optional<Payload> payload{};       // none: not said
  std::vector<Via> via{};
  std::string request_hash{}, status{};  // empty: not said
};

// From the plan.json in the folder of a plan. Throws InputError where there is none, or none of a motion, or where its
// via_times are no times between the motion's segments.
PlannedMotion planned_motion(const std::filesystem::path& folder);
// The same from its text. source: what it is called in messages.
PlannedMotion planned_motion_in(const std::string& plan_json, const std::string& source);

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
