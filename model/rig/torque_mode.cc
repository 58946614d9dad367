// Motor inertia, IV-F: link removed, constant friction-compensated torques from standstill.
#include <algorithm>
#include <cmath>
#include <memory>

#include "common/normal.h"
#include "model/rig/experiments.h"
#include "model/rig/simulated_arm.h"

namespace fjr {
namespace {

// The friction compensation of the drive (26): u + tau_fm_nonlinear(v), where v is the velocity measured by the drive.
// Its noise changes every millisecond; otherwise the loop is ideal.
struct Compensation {
  FrictionLaw law;
  double u = 0;        // [N m]
  double noise = 0;    // [rad/s]
  bool braked = true;  // before and between the pushes

  double torque(double dtheta) const { return braked ? law.torque(dtheta) : u + law.nonlinear(dtheta + noise); }
};

constexpr double kTickRate = 1000;  // [Hz]

class TorqueMode {
 public:
  TorqueMode(const Rig& rig, int joint, const ConstantTorques& plan)
      : rig_(rig),
        joint_(joint),
        j_(static_cast<std::size_t>(joint)),
        plan_(plan),
        ticks_per_row_(std::max(1L, std::lround(kTickRate / plan.sample_rate))),
        tick_rate_(plan.sample_rate * static_cast<double>(ticks_per_row_)),
        compensation_(std::make_shared<Compensation>(Compensation{FrictionLaw::of(rig.truth, joint)})),
        arm_(rig, mounting()),
        noise_(rig.seed * 16 + 3) {
    record_.log_velocity = true;
  }

  Record perform() {
    for (const double u : plan_.torques) {
      push(u);
      push(-u);
    }
    return std::move(record_);
  }

 private:
  Mounting mounting() const {
    Mounting m;
    m.links = {LinkMount::kRemoved, LinkMount::kRemoved};
    m.drives[j_] = {{}, [c = compensation_](double, double dtheta) { return c->torque(dtheta); }};
    return m;
  }

  void push(double u) {
    compensation_->braked = true;
    arm_.stop_motor(joint_);
    run(plan_.rest);
    compensation_->braked = false;
    compensation_->u = u;
    arm_.restart();
    run(plan_.push);
  }

  void run(double duration) {
    const auto ticks = std::lround(duration * tick_rate_);
    for (long i = 0; i < ticks; ++i) {
      Joints<double> velocity = arm_.state().dtheta;
      if (rig_.noisy()) {
        compensation_->noise = rig_.instruments.velocity_noise[j_] * noise_();
        velocity[j_] += compensation_->noise;
        arm_.restart();
      }
      if (ticks_ % ticks_per_row_ == 0) {
        record_.add(arm_.time(), arm_.state(), arm_.motor_torque());
        record_.drive_velocity.push_back(velocity);
        record_.planned[joint_column("u", joint_, "_plan")].push_back(compensation_->braked ? 0 : compensation_->u);
      }
      const double end = static_cast<double>(++ticks_) / tick_rate_;
      arm_.announce_corner(end);
      arm_.advance(end);
    }
  }

  const Rig& rig_;
  int joint_;
  std::size_t j_;
  const ConstantTorques& plan_;
  long ticks_per_row_;
  double tick_rate_;  // [Hz]  of the drive: at least kTickRate, and as often as the log or a multiple of it
  std::shared_ptr<Compensation> compensation_;
  SimulatedArm arm_;
  Normal noise_;
  Record record_;
  long ticks_ = 0;
};

}  // namespace

Record perform_motor_inertia(const Rig& rig, int joint, const ConstantTorques& torques, const RigProgress&) {
  return TorqueMode(rig, joint, torques).perform();
}

}  // namespace fjr
