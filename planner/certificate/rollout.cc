#include "planner/certificate/rollout.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "model/dual.h"
#include "model/rig/sundials_handles.h"

namespace fjr {
namespace {

// From one start on. A rollout that needs more has broken down: 20 s of hard work take 400 thousand.
constexpr long kMaxSteps = 5'000'000;
// CVODE refuses to start towards a time that is nearer than rounding; times that should be equal often are. [s]
constexpr double kNegligible = 1e-10;
constexpr int kReversalRoots = kJoints;
constexpr int kRoots = 4 * kJoints;

using Active = Dual<kStates>;

State<double> read(N_Vector v) { return State<double>::from(N_VGetArrayPointer(v)); }

void write(const State<double>& x, N_Vector v) { std::copy_n(x.data(), kStates, N_VGetArrayPointer(v)); }

bool finite(const State<double>& x) {
  return std::all_of(x.data(), x.data() + kStates, [](double value) { return std::isfinite(value); });
}

void ignore_message(int, const char*, const char*, char*, void*) {}  // flags say the same, and are all looked at

std::string flag_name(int flag) {
  char* name = CVodeGetReturnFlagName(flag);
  std::string text = name;
  std::free(name);
  return text;
}

// limit^2 - x^2: positive inside, smooth, and it changes sign where the limit is crossed. No limit: never zero.
double inside(double limit, double x) { return std::isfinite(limit) ? limit * limit - x * x : 1.0; }

}  // namespace

struct Rollout::Memory {
  Parameters robot;
  Limits limits;
  Drive drive;
  std::optional<Interpolator> plan;
  double time = 0;
  State<double> state{};
  std::vector<Event> events;
  std::string failure;
  long steps = 0;  // since the last start
  long evaluations = 0;

  sundials::Context context = sundials::make_context();
  sundials::Vector x{sundials::check(N_VNew_Serial(kStates, context.get()), "N_VNew_Serial")};
  sundials::Vector between{sundials::check(N_VNew_Serial(kStates, context.get()), "N_VNew_Serial")};
  sundials::Matrix jacobian{sundials::check(SUNDenseMatrix(kStates, kStates, context.get()), "SUNDenseMatrix")};
  sundials::LinearSolver solver{
      sundials::check(SUNLinSol_Dense(x.get(), jacobian.get(), context.get()), "SUNLinSol_Dense")};
  sundials::Cvode cvode{sundials::check(CVodeCreate(CV_BDF, context.get()), "CVodeCreate")};

  Memory(const Parameters& p, const Limits& l, const Accuracy& accuracy);

  void restart();
  void jump_to(double end, std::span<const double>& instants, const Observer& observe);
  bool run_to(double end, std::span<const double>& instants, const Observer& observe);
  void observe_until(double until, std::span<const double>& instants, const Observer& observe);
  void record_events();

  Pair<double> torque(double t, const State<double>& x_now);
  template <class T>
  State<T> derivative(const State<T>& x_now, const Pair<T>& tau) const {
    return dynamics(robot, x_now, tau);
  }

  static int rhs(realtype t, N_Vector x, N_Vector dx, void* self);
  static int fill_jacobian(realtype t, N_Vector x, N_Vector fx, SUNMatrix j, void* self, N_Vector, N_Vector, N_Vector);
  static int roots(realtype t, N_Vector x, realtype* g, void* self);
};

Rollout::Memory::Memory(const Parameters& p, const Limits& l, const Accuracy& accuracy) : robot(p), limits(l) {
  using sundials::check;
  const sundials::Vector absolute(check(N_VNew_Serial(kStates, context.get()), "N_VNew_Serial"));
  write({{accuracy.position, accuracy.position},
         {accuracy.link_velocity, accuracy.link_velocity},
         {accuracy.position, accuracy.position},
         {accuracy.motor_velocity, accuracy.motor_velocity}},
        absolute.get());
  N_VConst(0.0, x.get());
  check(CVodeInit(cvode.get(), rhs, 0.0, x.get()), "CVodeInit");
  check(CVodeSetErrHandlerFn(cvode.get(), ignore_message, nullptr), "CVodeSetErrHandlerFn");
  check(CVodeSVtolerances(cvode.get(), accuracy.relative, absolute.get()), "CVodeSVtolerances");
  check(CVodeSetUserData(cvode.get(), this), "CVodeSetUserData");
  check(CVodeSetLinearSolver(cvode.get(), solver.get(), jacobian.get()), "CVodeSetLinearSolver");
  check(CVodeSetJacFn(cvode.get(), fill_jacobian), "CVodeSetJacFn");
  check(CVodeRootInit(cvode.get(), kRoots, roots), "CVodeRootInit");
  check(CVodeSetNoInactiveRootWarn(cvode.get()), "CVodeSetNoInactiveRootWarn");  // a motor at rest is at a root
}

Pair<double> Rollout::Memory::torque(double t, const State<double>& x_now) {
  const bool closed = drive.position_gain != Pair<double>{} || drive.velocity_gain != Pair<double>{};
  if (!closed) return plan ? plan->torque_at(t) : drive.held.torque;
  const Sample reference = plan ? plan->at(t) : drive.held;
  const Pair<double> feedback = drive.feedback(reference.state, x_now);
  return {reference.torque[0] + feedback[0], reference.torque[1] + feedback[1]};
}

int Rollout::Memory::rhs(realtype t, N_Vector x, N_Vector dx, void* self) {
  auto& m = *static_cast<Memory*>(self);
  ++m.evaluations;
  const State<double> now = read(x);
  const State<double> f = m.derivative(now, m.torque(t, now));
  write(f, dx);
  return finite(f) ? 0 : 1;  // 1: CVODE tries again with a smaller step
}

int Rollout::Memory::fill_jacobian(realtype t, N_Vector x, N_Vector, SUNMatrix j, void* self, N_Vector, N_Vector,
                                   N_Vector) {
  auto& m = *static_cast<Memory*>(self);
  const State<double> now = read(x);
  const Pair<double> tau_now = m.torque(t, now);
  State<Active> active;
  for (int i = 0; i < kStates; ++i) active.data()[i] = Active::input(now.data()[i], i);
  Pair<Active> tau;
  for (std::size_t k = 0; k < kJoints; ++k) {
    tau[k] = tau_now[k] - m.drive.position_gain[k] * (active.theta[k] - now.theta[k]) -
             m.drive.velocity_gain[k] * (active.dtheta[k] - now.dtheta[k]);
  }
  const State<Active> f = m.derivative(active, tau);
  for (int column = 0; column < kStates; ++column) {
    realtype* entries = SM_COLUMN_D(j, column);
    for (int row = 0; row < kStates; ++row) entries[row] = f.data()[row].g[static_cast<std::size_t>(column)];
  }
  return 0;
}

int Rollout::Memory::roots(realtype, N_Vector x, realtype* g, void* self) {
  const auto& m = *static_cast<const Memory*>(self);
  const State<double> now = read(x);
  for (std::size_t j = 0; j < kJoints; ++j) {
    g[j] = now.dtheta[j];
    g[2 + j] = inside(m.limits.motor_velocity[j], now.dtheta[j]);
    g[4 + j] = inside(m.limits.link_position[j], now.q[j]);
    g[6 + j] = inside(m.limits.spring_deflection[j], now.theta[j] - now.q[j]);
  }
  return 0;
}

void Rollout::Memory::restart() {
  write(state, x.get());
  sundials::check(CVodeReInit(cvode.get(), time, x.get()), "CVodeReInit");
}

void Rollout::Memory::record_events() {
  std::array<int, kRoots> found{};
  sundials::check(CVodeGetRootInfo(cvode.get(), found.data()), "CVodeGetRootInfo");
  for (int i = 0; i < kRoots; ++i) {
    const int direction = found[static_cast<std::size_t>(i)];
    const bool entering = i >= kReversalRoots && direction > 0;  // coming back inside a limit is no event
    if (direction != 0 && !entering) events.push_back({time, static_cast<Event::Kind>(i / kJoints), i % kJoints + 1});
  }
}

void Rollout::Memory::observe_until(double until, std::span<const double>& instants, const Observer& observe) {
  while (!instants.empty() && instants.front() <= until) {
    const double at = instants.front();
    instants = instants.subspan(1);
    if (at == time) {
      observe(at, state);
      continue;
    }
    sundials::check(CVodeGetDky(cvode.get(), at, 0, between.get()), "CVodeGetDky");
    observe(at, read(between.get()));
  }
}

// Lets a negligible time pass in which nothing happens.
void Rollout::Memory::jump_to(double end, std::span<const double>& instants, const Observer& observe) {
  time = end;
  restart();
  for (; !instants.empty() && instants.front() <= end; instants = instants.subspan(1)) observe(instants.front(), state);
}

bool Rollout::Memory::run_to(double end, std::span<const double>& instants, const Observer& observe) {
  if (end - time < kNegligible) {
    jump_to(end, instants, observe);
    return true;
  }
  sundials::check(CVodeSetStopTime(cvode.get(), end), "CVodeSetStopTime");
  bool at_root = false;
  for (; time < end; ++steps) {
    int flag = CVode(cvode.get(), end, x.get(), &time, CV_ONE_STEP);
    if (flag == CV_ILL_INPUT && at_root) {  // CVODE's own guard: a root function that stays exactly zero after a root
      restart();
      sundials::check(CVodeSetStopTime(cvode.get(), end), "CVodeSetStopTime");
      at_root = false;
      continue;
    }
    state = read(x.get());
    if (flag < 0 || !finite(state) || steps > kMaxSteps) {
      failure =
          "integration stopped at " + std::to_string(time) + " s: " + (flag < 0 ? flag_name(flag) : "too many steps");
      return false;
    }
    at_root = flag == CV_ROOT_RETURN;
    if (at_root) record_events();
    observe_until(time, instants, observe);
  }
  return true;
}

Rollout::Rollout(const Parameters& robot, const Limits& limits, const Accuracy& accuracy)
    : memory_(std::make_unique<Memory>(robot, limits, accuracy)) {}

Rollout::~Rollout() = default;

void Rollout::start(double time, const State<double>& state, const Drive& drive) {
  memory_->time = time;
  memory_->state = state;
  memory_->events.clear();
  memory_->failure.clear();
  memory_->steps = 0;
  redirect(drive);
}

void Rollout::redirect(const Drive& drive) {
  memory_->drive = drive;
  memory_->plan.reset();
  if (drive.plan != nullptr) memory_->plan.emplace(*drive.plan);
  memory_->restart();
}

void Rollout::hold(const Pair<double>& torque) { memory_->drive.held.torque = torque; }

bool Rollout::run(double end, std::span<const double> instants, std::span<const double> stops,
                  const Observer& observe) {
  for (const double stop : stops) {
    if (stop - memory_->time < kNegligible) continue;
    if (end - stop < kNegligible) break;
    if (!memory_->run_to(stop, instants, observe)) return false;
    memory_->restart();
  }
  return memory_->run_to(end, instants, observe);
}

void Rollout::limit_step(double longest) {
  sundials::check(CVodeSetMaxStep(memory_->cvode.get(), longest), "CVodeSetMaxStep");
}

double Rollout::time() const { return memory_->time; }
const State<double>& Rollout::state() const { return memory_->state; }
const std::vector<Event>& Rollout::events() const { return memory_->events; }
const std::string& Rollout::failure() const { return memory_->failure; }
long Rollout::evaluations() const { return memory_->evaluations; }

std::vector<double> torque_corners(const Trajectory& trajectory, double slope_change) {
  const std::vector<Sample>& rows = trajectory.samples;
  const auto slope = [&](std::size_t k, std::size_t j) {
    return (rows[k + 1].torque[j] - rows[k].torque[j]) / (rows[k + 1].time - rows[k].time);
  };
  std::vector<double> corners;
  for (std::size_t k = 1; k + 1 < rows.size(); ++k) {
    bool corner = false;
    for (std::size_t j = 0; j < kJoints; ++j) corner |= std::abs(slope(k, j) - slope(k - 1, j)) > slope_change;
    if (corner) corners.push_back(rows[k].time);
  }
  return corners;
}

double longest_interval(const Trajectory& trajectory) {
  double longest = 0;
  for (std::size_t k = 0; k + 1 < trajectory.samples.size(); ++k) {
    longest = std::max(longest, trajectory.samples[k + 1].time - trajectory.samples[k].time);
  }
  return longest;
}

double longest_step(const Trajectory& trajectory) { return std::min(longest_interval(trajectory), kLongestStep); }

}  // namespace fjr
