#include "model/rig/simulated_arm.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/sundials_handles.h"

namespace fjr {
namespace {

constexpr double kRelative = 1e-8, kAbsolute = 1e-10;  // error of one step: far below a count, 9.6e-5 rad
constexpr long kMaxSteps = 2'000'000;                  // of one advance
constexpr double kNegligible = 1e-12;                  // [s]

struct RigState {
  State<double> arm;
  Joints<double> z;  // of the hysteresis, from -1 to 1
};
constexpr int kSize = kStates + kJoints;

RigState read(N_Vector v) {
  const double* y = N_VGetArrayPointer(v);
  return {State<double>::from(y), {y[kStates], y[kStates + 1]}};
}

void write(const RigState& s, N_Vector v) {
  double* y = N_VGetArrayPointer(v);
  s.arm.copy_to(y);
  std::copy_n(s.z.data(), kJoints, y + kStates);
}

}  // namespace

struct SimulatedArm::Memory {
  Rig rig;
  Mounting mounting;
  double time = 0;

  sundials::Context context = sundials::make_context();
  sundials::Vector y{sundials::check(N_VNew_Serial(kSize, context.get()), "N_VNew_Serial")};
  sundials::NonlinearSolver iteration{
      sundials::check(SUNNonlinSol_FixedPoint(y.get(), 0, context.get()), "SUNNonlinSol_FixedPoint")};
  sundials::Cvode cvode{sundials::check(CVodeCreate(CV_ADAMS, context.get()), "CVodeCreate")};

  Memory(const Rig& r, Mounting m) : rig(r), mounting(std::move(m)) {
    using sundials::check;
    if (!mounting.gravity) rig.truth.link.gravity_torque = {0, 0};
    N_VConst(0.0, y.get());
    check(CVodeInit(cvode.get(), rhs, 0.0, y.get()), "CVodeInit");
    sundials::prepare_cvode(cvode.get());
    check(CVodeSStolerances(cvode.get(), kRelative, kAbsolute), "CVodeSStolerances");
    check(CVodeSetUserData(cvode.get(), this), "CVodeSetUserData");
    check(CVodeSetNonlinearSolver(cvode.get(), iteration.get()), "CVodeSetNonlinearSolver");
    check(CVodeSetMaxNumSteps(cvode.get(), kMaxSteps), "CVodeSetMaxNumSteps");
  }

  bool removed(std::size_t j) const { return mounting.links[j] == LinkMount::kRemoved; }
  bool clamped(std::size_t j) const { return mounting.links[j] != LinkMount::kFree; }

  // Replaces the states of motors with a prescribed motion, which are not integrated.
  RigState with_prescribed_motors(double t, RigState s) const {
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (!mounting.drives[j].motion) continue;
      const MotorMotion m = mounting.drives[j].motion(t);
      s.arm.theta[j] = m.theta;
      s.arm.dtheta[j] = m.dtheta;
    }
    return s;
  }

  // Returns tau_c of (1) including the hysteresis of the rig.
  Joints<double> spring(const RigState& s) const {
    Joints<double> tau = spring_torque(rig.truth, s.arm.q, s.arm.theta);
    for (std::size_t j = 0; j < kJoints; ++j) tau[j] = removed(j) ? 0 : tau[j] + rig.hysteresis.height[j] * s.z[j];
    return tau;
  }

  // Solves the link side of (1) for the acceleration under the torque `tau`. A clamp gives any torque that is needed.
  Joints<double> link_acceleration_under(const State<double>& x, const Joints<double>& tau) const {
    if (!clamped(0) && !clamped(1)) return link_acceleration(rig.truth, x.q, x.dq, tau);
    const MassMatrix<double> m = mass_matrix(rig.truth, x.q[1]);
    const Joints<double> c = coriolis_torque(rig.truth, x.q, x.dq), g = gravity_torque(rig.truth, x.q);
    const Joints<double> inertia{m.m11, m.m22};
    Joints<double> ddq{0, 0};
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (!clamped(j)) ddq[j] = (tau[j] - c[j] - g[j] - rig.truth.link.damping[j] * x.dq[j]) / inertia[j];
    }
    return ddq;
  }

  double motor_torque(std::size_t j, double t, const RigState& s, const Joints<double>& tau_c) const {
    const MotorDrive& drive = mounting.drives[j];
    if (drive.torque) return drive.torque(t, s.arm.dtheta[j]);
    const double friction = FrictionLaw::of(rig.truth, static_cast<int>(j)).torque(s.arm.dtheta[j]);
    return rig.truth.motor.inertia[j] * drive.motion(t).ddtheta + friction + tau_c[j];
  }

  RigState derivative(double t, const RigState& integrated) const {
    const RigState s = with_prescribed_motors(t, integrated);
    const Joints<double> tau_c = spring(s);
    Joints<double> on_links = tau_c;
    if (mounting.push) {
      const Joints<double> push = mounting.push(t);
      for (std::size_t j = 0; j < kJoints; ++j) on_links[j] += push[j];
    }
    RigState f{};
    f.arm.q = s.arm.dq;
    f.arm.dq = link_acceleration_under(s.arm, on_links);
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double rate = s.arm.dtheta[j] - s.arm.dq[j];
      f.z[j] = removed(j) ? 0 : (rate - s.z[j] * std::abs(rate)) / rig.hysteresis.width[j];
      if (mounting.drives[j].motion) continue;  // not integrated
      f.arm.theta[j] = s.arm.dtheta[j];
      const double friction = FrictionLaw::of(rig.truth, static_cast<int>(j)).torque(s.arm.dtheta[j]);
      f.arm.dtheta[j] = (motor_torque(j, t, s, tau_c) - friction - tau_c[j]) / rig.truth.motor.inertia[j];
    }
    return f;
  }

  static int rhs(sunrealtype t, N_Vector y, N_Vector dy, void* self) {
    write(static_cast<const Memory*>(self)->derivative(t, read(y)), dy);
    return 0;
  }

  void restart() { sundials::check(CVodeReInit(cvode.get(), time, y.get()), "CVodeReInit"); }
};

SimulatedArm::SimulatedArm(const Rig& rig, Mounting mounting)
    : memory_(std::make_unique<Memory>(rig, std::move(mounting))) {}

SimulatedArm::~SimulatedArm() = default;

void SimulatedArm::announce_corner(double time) {
  sundials::check(CVodeSetStopTime(memory_->cvode.get(), time), "CVodeSetStopTime");
}

void SimulatedArm::advance(double time) {
  if (time - memory_->time < kNegligible) return;
  sundials::check(CVode(memory_->cvode.get(), time, memory_->y.get(), &memory_->time, CV_NORMAL), "CVode");
}

void SimulatedArm::restart() { memory_->restart(); }

void SimulatedArm::stop_motor(int joint) {
  RigState s = read(memory_->y.get());
  s.arm.dtheta[static_cast<std::size_t>(joint)] = 0;
  write(s, memory_->y.get());
  restart();
}

double SimulatedArm::time() const { return memory_->time; }

State<double> SimulatedArm::state() const {
  return memory_->with_prescribed_motors(memory_->time, read(memory_->y.get())).arm;
}

Joints<double> SimulatedArm::motor_torque() const {
  const RigState s = memory_->with_prescribed_motors(memory_->time, read(memory_->y.get()));
  const Joints<double> tau_c = memory_->spring(s);
  return {memory_->motor_torque(0, memory_->time, s, tau_c), memory_->motor_torque(1, memory_->time, s, tau_c)};
}

}  // namespace fjr
