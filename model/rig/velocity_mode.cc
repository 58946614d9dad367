// Motor friction, IV-E: link removed, constant speeds. The drive is told where to be, so there is nothing to integrate.
#include <algorithm>
#include <cmath>

#include "model/rig/experiments.h"

namespace fjr {
namespace {

void add_logarithmic(std::vector<double>& speeds, double from, double to, int count) {
  for (int i = 0; i < count; ++i) speeds.push_back(from * std::pow(to / from, i / (count - 1.0)));
}

void add_linear(std::vector<double>& speeds, double from, double to, int count) {
  for (int i = 0; i < count; ++i) speeds.push_back(from + (to - from) * i / (count - 1.0));
}

// A run at one speed: a ramp from standstill, constant speed, and an immediate stop (not logged).
class Run {
 public:
  Run(const Rig& rig, int joint, const ConstantSpeeds& plan, Record& record)
      : law_(FrictionLaw::of(rig.truth, joint)),
        inertia_(rig.truth.motor.inertia[static_cast<std::size_t>(joint)]),
        j_(static_cast<std::size_t>(joint)),
        plan_(plan),
        record_(record),
        planned_(record.planned[joint_column("dtheta", joint, "_plan")]) {}

  void at(double speed) {
    const auto rows = static_cast<int>(std::lround((plan_.ramp + plan_.hold) * plan_.sample_rate));
    for (int i = 1; i <= rows; ++i) {
      const double t = i / plan_.sample_rate, in_ramp = std::min(t, plan_.ramp);
      State<double> x{};
      x.theta[j_] = position_ + speed * (0.5 * in_ramp * in_ramp / plan_.ramp + (t - in_ramp));
      x.dtheta[j_] = speed * (in_ramp / plan_.ramp);
      Joints<double> tau{0, 0};
      tau[j_] = law_.torque(x.dtheta[j_]) + (t < plan_.ramp ? inertia_ * speed / plan_.ramp : 0);
      record_.add(static_cast<double>(record_.time.size()) / plan_.sample_rate, x, tau);
      planned_.push_back(x.dtheta[j_]);
    }
    position_ = record_.states.back().theta[j_];
  }

 private:
  FrictionLaw law_;
  double inertia_;
  std::size_t j_;
  const ConstantSpeeds& plan_;
  Record& record_;
  std::vector<double>& planned_;
  double position_ = 0;
};

}  // namespace

ConstantSpeeds ConstantSpeeds::of(int joint, bool slow) {
  ConstantSpeeds plan;
  if (slow && joint == 0) add_logarithmic(plan.speeds, 3e-5, 5e-4, 16);
  if (slow && joint == 1) add_logarithmic(plan.speeds, 1e-4, 3.9e-3, 16);
  add_logarithmic(plan.speeds, joint == 0 ? 0.01 : 4e-3, 6, 30);
  if (joint == 1) add_linear(plan.speeds, 0.15, 0.5, 20);
  return plan;
}

Record perform_motor_friction(const Rig& rig, int joint, const ConstantSpeeds& speeds, const RigProgress&) {
  Record record;
  record.log_velocity = true;
  Run run(rig, joint, speeds, record);
  for (const double speed : speeds.speeds) {
    run.at(speed);
    run.at(-speed);
  }
  return record;
}

}  // namespace fjr
