#include <algorithm>
#include <stdexcept>

#include "model/identify/charts.h"
#include "model/identify/checks.h"
#include "model/identify/procedures.h"

namespace fjr {

const std::vector<Procedure>& procedures() {
  static const std::vector<Procedure> all{
      {"stiffness", identify_stiffness, stiffness_charts, {ArmInput::kStiffness}, {}},
      {"gravity", identify_gravity, gravity_charts, {ArmInput::kGravitySlope}, {}},
      {"link_inertia",
       identify_link_inertia,
       link_inertia_charts,
       {ArmInput::kStiffnessOverInertia, ArmInput::kDampingOverInertia},
       {}},
      {"motor_friction",
       identify_motor_friction,
       motor_friction_charts,
       {},
       {"friction.viscous", "friction.amplitude", "friction.width", "friction.second_weight", "friction.second_shape"}},
      {"motor_inertia", identify_motor_inertia, motor_inertia_charts, {}, {"motor.inertia"}},
  };
  return all;
}

const Procedure* find_procedure(std::string_view name) {
  const std::vector<Procedure>& all = procedures();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Procedure& p) { return p.name == name; });
  return found == all.end() ? nullptr : &*found;
}

Estimate identify(const std::string& name, const Log& log, int joint, const Parameters& robot) {
  const Procedure* procedure = find_procedure(name);
  if (procedure == nullptr) throw std::invalid_argument("no procedure is named " + name);
  require_experiment(log, name, joint);
  Estimate estimate = procedure->identify(log, joint, robot);
  estimate.procedure = name;
  estimate.joint = joint;
  estimate.log = log.source;
  estimate.hash = log.hash;
  return estimate;
}

std::vector<Chart> charts_of(const Estimate& estimate) {
  const Procedure* procedure = find_procedure(estimate.procedure);
  if (procedure == nullptr || !estimate.fitted.has_value()) return {};
  return procedure->charts(estimate);
}

}  // namespace fjr
