#include "planner/identify/executed_robot.h"

#include "model/identify/robot_file.h"

namespace fjr {
namespace {

std::vector<Estimate> logs_of(const std::vector<ExecutedMotion>& motions) {
  std::vector<Estimate> logs;
  for (const ExecutedMotion& motion : motions) {
    Estimate log;
    log.procedure = "executed";
    log.log = motion.log;
    log.hash = motion.hash;
    logs.push_back(log);
  }
  return logs;
}

Identified identified_by(const ExecutedFit& fit, const std::vector<Estimate>& logs) {
  Identified identified{
      .robot = fit.robot, .names = {}, .covariance = fit.covariance, .from = {}, .damping = {}, .damping_error = {}};
  for (const RefinedParameter& p : fit.parameters) {
    identified.names.push_back(p.name);
    if (p.name == "payload.mass") identified.robot.payload.mass_error = p.error;
    if (p.name == "payload.inertia") identified.robot.payload.inertia_error = p.error;
    if (!p.refined()) continue;
    for (const Estimate& log : logs) identified.from[p.name].push_back(&log);
  }
  return identified;
}

}  // namespace

Parameters write_executed_robot(const std::filesystem::path& file, const std::filesystem::path& base,
                                const ExecutedFit& fit, const std::vector<ExecutedMotion>& motions) {
  const std::vector<Estimate> logs = logs_of(motions);
  return write_robot_file(file, format_robot(identified_by(fit, logs), base, false));
}

}  // namespace fjr
