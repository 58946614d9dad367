// Link inertia, IV-C: a push, then free decay.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "model/rig/experiments.h"
#include "model/rig/simulated_arm.h"

namespace fjr {
namespace {

constexpr double kStart = 0.2, kLength = 0.01;  // [s]  of the push, half a sine

}  // namespace

Record perform_link_inertia(const Rig& rig, int joint, const Impulse& impulse, const RigProgress&) {
  const auto j = static_cast<std::size_t>(joint);
  const MassMatrix<double> m = mass_matrix(rig.truth, 0.0);
  const double inertia = joint == 0 ? m.m11 : m.m22;
  // A momentum P causes an oscillation of amplitude P / sqrt(K I); half a sine of height h has the momentum 2 h kLength
  // / pi.
  const double momentum = impulse.amplitude * std::sqrt(rig.truth.spring.stiffness[j] * inertia);
  const double height = momentum * std::numbers::pi / (2 * kLength);
  Mounting mounting;
  mounting.links[1 - j] = LinkMount::kClamped;
  mounting.gravity = impulse.gravity;
  mounting.push = [height, j](double t) {
    Joints<double> push{0, 0};
    const double phase = (t - kStart) / kLength;
    if (phase > 0 && phase < 1) push[j] = height * std::sin(std::numbers::pi * phase);
    return push;
  };
  SimulatedArm arm(rig, std::move(mounting));
  Record record;
  std::vector<double> corners{impulse.duration + 1, kStart + kLength, kStart};  // the next one last
  arm.announce_corner(corners.back());
  const auto rows = static_cast<int>(std::lround(impulse.duration * impulse.sample_rate));
  for (int row = 0; row <= rows; ++row) {
    const double t = row / impulse.sample_rate;
    while (corners.size() > 1 && t >= corners.back()) {
      arm.advance(corners.back());
      corners.pop_back();
      arm.restart();
      arm.announce_corner(corners.back());
    }
    arm.advance(t);
    record.add(t, arm.state(), arm.motor_torque());
  }
  return record;
}

}  // namespace fjr
