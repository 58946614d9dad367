#include <fmt/format.h>

#include <stdexcept>

#include "model/rig/experiments.h"

namespace fjr {
namespace {

Record perform_named(const std::string& name, const Rig& rig, int joint, bool slow, const RigProgress& progress) {
  if (name == "stiffness") return perform_stiffness(rig, joint, Staircase::of_stiffness(joint), progress);
  if (name == "gravity") return perform_gravity(rig, joint, Staircase::of_gravity(joint), progress);
  if (name == "link_inertia") return perform_link_inertia(rig, joint, Impulse::of(joint));
  if (name == "motor_friction") return perform_motor_friction(rig, joint, ConstantSpeeds::of(joint, slow));
  if (name == "motor_inertia") return perform_motor_inertia(rig, joint, ConstantTorques::of(joint));
  throw std::invalid_argument("no experiment is named " + name);
}

}  // namespace

Record perform(const std::string& name, const Rig& rig, int joint, bool slow, const RigProgress& progress) {
  Record record = perform_named(name, rig, joint, slow, progress);
  record.metadata["experiment"] = name;
  record.metadata["joint"] = fmt::format("{}", joint + 1);
  return record;
}

}  // namespace fjr
