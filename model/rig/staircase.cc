// Stiffness and gravity, IV-A and IV-B: one motor climbs and descends a staircase.
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "model/rig/experiments.h"
#include "model/rig/simulated_arm.h"

namespace fjr {
namespace {

// Returns the level, in steps, after `moves` moves of 0 -> +n -> 0 -> -n -> 0.
int level(int moves, int n) {
  if (moves <= n) return moves;
  return moves <= 3 * n ? 2 * n - moves : moves - 4 * n;
}

// Returns s^3 (10 - 15 s + 6 s^2), which goes from 0 to 1 with zero velocity and acceleration at the ends, with
// derivatives.
MotorMotion smooth_step(double s) {
  return {s * s * s * (10 + s * (-15 + 6 * s)), 30 * s * s * (1 - s) * (1 - s), 60 * s * (1 - s) * (1 - 2 * s)};
}

MotorMotion motion(const Staircase& stairs, double time) {
  const int moves = static_cast<int>(std::floor(time / stairs.period + 1e-9));
  const double from = stairs.step * level(moves, stairs.steps);
  const double rise = stairs.step * level(moves + 1, stairs.steps) - from;
  const double s = (time - moves * stairs.period) / stairs.move;
  if (s >= 1) return {from + rise, 0, 0};
  const MotorMotion unit = smooth_step(std::max(s, 0.0));
  return {from + rise * unit.theta, rise * unit.dtheta / stairs.move,
          rise * unit.ddtheta / (stairs.move * stairs.move)};
}

// The rest periods are integrated as well. They cost little, because the integrator takes short steps only while
// something oscillates.
Record climb(const Rig& rig, int joint, const Staircase& stairs, Mounting mounting, const RigProgress& progress) {
  mounting.drives[static_cast<std::size_t>(joint)] = {[stairs](double t) { return motion(stairs, t); }, {}};
  SimulatedArm arm(rig, std::move(mounting));
  Record record;
  const auto per_period = static_cast<int>(std::lround(stairs.period * stairs.sample_rate));
  const int moves = 4 * stairs.steps;
  for (int move = 0; move < moves; ++move) {
    const double start = move * stairs.period, moved = start + stairs.move;
    arm.restart();
    arm.announce_corner(moved);
    for (int i = 0; i < per_period; ++i) {
      const double t = start + i / stairs.sample_rate;
      if (arm.time() < moved && t >= moved) {
        arm.advance(moved);
        arm.restart();
        arm.announce_corner(start + stairs.period);
      }
      arm.advance(t);
      record.add(t, arm.state(), arm.motor_torque());
    }
    arm.advance(start + stairs.period);
    if (progress && !progress((move + 1.0) / moves)) throw std::runtime_error("interrupted");
  }
  record.metadata["period"] = fmt::format("{}", stairs.period);
  record.metadata["average"] = fmt::format("{}", stairs.average);
  return record;
}

}  // namespace

Record perform_stiffness(const Rig& rig, int joint, const Staircase& staircase, const RigProgress& progress) {
  Mounting mounting;
  mounting.links = {LinkMount::kClamped, LinkMount::kClamped};
  mounting.gravity = staircase.gravity;
  return climb(rig, joint, staircase, std::move(mounting), progress);
}

Record perform_gravity(const Rig& rig, int joint, const Staircase& staircase, const RigProgress& progress) {
  Mounting mounting;
  mounting.links[static_cast<std::size_t>(1 - joint)] = LinkMount::kClamped;
  mounting.gravity = staircase.gravity;
  return climb(rig, joint, staircase, std::move(mounting), progress);
}

}  // namespace fjr
