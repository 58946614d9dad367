// Link inertia, IV-C: a push, then free decay.
#include <cmath>
#include <numbers>

#include "model/rig/experiments.h"
#include "model/rig/simulated_arm.h"

namespace fjr {
namespace {

constexpr double kStart = 0.2, kLength = 0.01;  // [s]  of the push, half a sine

}  // namespace

Record perform_link_inertia(const Rig& rig, int joint, const Impulse& impulse) {
  const auto j = static_cast<std::size_t>(joint);
  const MassMatrix<double> m = mass_matrix(rig.truth, 0.0);
  const double inertia = joint == 0 ? m.m11 : m.m22;
  // A momentum P makes a swing of P / sqrt(K I); half a sine of height h holds 2 h kLength / pi.
  const double momentum = impulse.amplitude * std::sqrt(rig.truth.spring.stiffness[j] * inertia);
  const double height = momentum * std::numbers::pi / (2 * kLength);
  Mounting mounting;
  mounting.links[1 - j] = LinkMount::kClamped;
  mounting.gravity = false;
  mounting.push = [height, j](double t) {
    Pair<double> push{0, 0};
    const double phase = (t - kStart) / kLength;
    if (phase > 0 && phase < 1) push[j] = height * std::sin(std::numbers::pi * phase);
    return push;
  };
  SimulatedArm arm(rig, std::move(mounting));
  Record record;
  int row = 0;
  for (const double corner : {kStart, kStart + kLength, impulse.duration}) {
    const auto last = static_cast<int>(std::lround(corner * impulse.sample_rate));
    arm.restart();
    arm.announce_corner(last / impulse.sample_rate);
    for (; row <= last; ++row) {
      arm.advance(row / impulse.sample_rate);
      record.add(arm.time(), arm.state(), arm.motor_torque());
    }
  }
  return record;
}

}  // namespace fjr
