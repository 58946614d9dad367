#include <fmt/format.h>

#include <stdexcept>

#include "model/rig/experiments.h"

namespace fjr {
namespace {

Record perform_named(const std::string& name, const Rig& rig, int joint, const Experiments& experiments,
                     const RigProgress& progress) {
  const auto j = static_cast<std::size_t>(joint);
  if (name == "stiffness") return perform_stiffness(rig, joint, experiments.stiffness[j], progress);
  if (name == "gravity") return perform_gravity(rig, joint, experiments.gravity[j], progress);
  if (name == "link_inertia") return perform_link_inertia(rig, joint, experiments.link_inertia[j]);
  if (name == "motor_friction") return perform_motor_friction(rig, joint, experiments.motor_friction[j]);
  if (name == "motor_inertia") return perform_motor_inertia(rig, joint, experiments.motor_inertia[j]);
  throw std::invalid_argument("no experiment is named " + name);
}

}  // namespace

Record perform(const std::string& name, const Rig& rig, int joint, const Experiments& experiments,
               const RigProgress& progress) {
  Record record = perform_named(name, rig, joint, experiments, progress);
  record.metadata["experiment"] = name;
  record.metadata["joint"] = fmt::format("{}", joint + 1);
  return record;
}

}  // namespace fjr
