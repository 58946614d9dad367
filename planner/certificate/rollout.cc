#include "planner/certificate/rollout.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <utility>

#include "common/dual.h"
#include "common/sundials_handles.h"

namespace fjr {
namespace {

// Steps since the last start. A rollout that needs more has broken down: 20 s of hard work take 400 thousand.
constexpr long kMaxSteps = 5'000'000;
// ARKODE refuses to start towards a time that is nearer than rounding; times that should be equal often are. [s]
constexpr double kNegligible = 1e-10;
constexpr double kMostGrowth = 1e4;
// An explicit step of order 5 is stable up to about 3 over this. [1/s]
constexpr double kStiff = 5000;
// A motor that passes through its band of stiff friction is out of it after fewer explicit steps.
constexpr int kStepsOfAPassage = 10;
constexpr int kReversalRoots = kJoints;

// Whether a limit is watched inside of steps: the robot's limits are, except for the torque, which is given.
constexpr bool is_watched(const LimitName& limit) { return limit.quantity->of_robot && !limit.quantity->sees_torque; }
constexpr int kWatched = static_cast<int>(std::count_if(kLimitNames.begin(), kLimitNames.end(), is_watched));
constexpr std::array<LimitName, kWatched> kWatchedLimits = [] {
  std::array<LimitName, kWatched> watched{};
  std::copy_if(kLimitNames.begin(), kLimitNames.end(), watched.begin(), is_watched);
  return watched;
}();
constexpr int kRoots = kReversalRoots + kWatched;

bool any_watched(const Limits& limits) {
  return std::any_of(kWatchedLimits.begin(), kWatchedLimits.end(),
                     [&](const LimitName& limit) { return std::isfinite(limit.in(limits)); });
}

using Active = Dual<kStates>;

State<double> read(N_Vector v) { return State<double>::from(N_VGetArrayPointer(v)); }

void write(const State<double>& x, N_Vector v) { x.copy_to(N_VGetArrayPointer(v)); }

bool finite(const State<double>& x) {
  for (std::size_t i = 0; i < kStates; ++i) {
    if (!std::isfinite(x[i])) return false;
  }
  return true;
}

// A serial vector of kStates numbers. The operations that a step consists of are loops of that length here: for eight
// numbers SUNDIALS' own, which look up lengths and cases first, took most of a rollout's time.
namespace short_vector {

sunrealtype* values(N_Vector v) { return NV_DATA_S(v); }  // a macro: no function is called

void linear_sum(sunrealtype a, N_Vector x, sunrealtype b, N_Vector y, N_Vector z) {
  for (std::size_t i = 0; i < kStates; ++i) values(z)[i] = a * values(x)[i] + b * values(y)[i];
}

void scale(sunrealtype a, N_Vector x, N_Vector z) {
  for (std::size_t i = 0; i < kStates; ++i) values(z)[i] = a * values(x)[i];
}

void fill(sunrealtype a, N_Vector z) { std::fill_n(values(z), kStates, a); }

int linear_combination(int count, sunrealtype* factors, N_Vector* of, N_Vector z) {
  std::array<sunrealtype, kStates> sum{};  // z may be one of them
  for (int k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < kStates; ++i) sum[i] += factors[k] * values(of[k])[i];
  }
  std::copy(sum.begin(), sum.end(), values(z));
  return 0;
}

sunrealtype weighted_mean_square_root(N_Vector x, N_Vector weights) {
  sunrealtype sum = 0;
  for (std::size_t i = 0; i < kStates; ++i) {
    const sunrealtype product = values(x)[i] * values(weights)[i];
    sum += product * product;
  }
  return std::sqrt(sum / kStates);
}

}  // namespace short_vector

N_Vector new_vector(SUNContext context) {
  N_Vector v = sundials::check(N_VNew_Serial(kStates, context), "N_VNew_Serial");
  v->ops->nvlinearsum = short_vector::linear_sum;  // its clones have these too
  v->ops->nvscale = short_vector::scale;
  v->ops->nvconst = short_vector::fill;
  v->ops->nvlinearcombination = short_vector::linear_combination;
  v->ops->nvwrmsnorm = short_vector::weighted_mean_square_root;
  return v;
}

std::string flag_name(int flag) {
  char* name = ARKStepGetReturnFlagName(flag);
  std::string text = name;
  std::free(name);
  return text;
}

// Speed below which motor j's friction changes with speed so steeply that its rate, slope / inertia, exceeds kStiff;
// 0 when it never does. [rad/s]
double band_of_stiff_friction(const Parameters& p, std::size_t j) {
  const FrictionLaw law = FrictionLaw::of(p, static_cast<int>(j));
  for (double v = 1e2 * law.width; v > 1e-7 * law.width; v *= 0.9) {
    if (law.slope(v) > kStiff * p.motor.inertia[j]) return v;
  }
  return 0;
}

// limit^2 - x^2: positive inside, smooth, and it changes sign where the limit is crossed. No limit: never zero.
double inside(double limit, double x) { return std::isfinite(limit) ? limit * limit - x * x : 1.0; }

}  // namespace

struct Rollout::Memory {
  Parameters robot;
  Limits limits;
  Drive drive;
  std::optional<Interpolator> plan;
  Joints<double> dither{};  // of the tick
  Joints<double> pushed{};  // on the links
  double time = 0;
  State<double> state{};
  std::vector<Event> events;
  std::string failure;
  Observer watch;
  long steps = 0;  // since the last start
  long evaluations = 0;

  sundials::Context context = sundials::make_context();
  sundials::Vector x{new_vector(context.get())};
  sundials::Vector between{new_vector(context.get())};
  sundials::Matrix jacobian{sundials::check(SUNDenseMatrix(kStates, kStates, context.get()), "SUNDenseMatrix")};
  sundials::LinearSolver solver{
      sundials::check(SUNLinSol_Dense(x.get(), jacobian.get(), context.get()), "SUNLinSol_Dense")};
  sundials::Arkode explicit_rk{
      sundials::check(ARKStepCreate(rhs, nullptr, 0, x.get(), context.get()), "ARKStepCreate")};
  sundials::Arkode stiff{sundials::check(ARKStepCreate(nullptr, rhs, 0, x.get(), context.get()), "ARKStepCreate")};
  void* active = explicit_rk.get();
  const Joints<double> stiff_band;  // [rad/s]
  int steps_in_band = 0;            // without a break

  Memory(const Parameters& p, const Limits& l, const Accuracy& accuracy);

  void begin(void* method);  // afresh
  void restart();            // after a jump, with the step size there was
  bool in_stiff_band() const;
  void choose_method(double end);
  void jump_to(double end, std::span<const double>& instants, const Observer& observe);
  bool run_to(double end, std::span<const double>& instants, const Observer& observe);
  void observe_until(double until, std::span<const double>& instants, const Observer& observe);
  void record_events();

  Joints<double> torque(double t, const State<double>& x_now);
  template <class T>
  State<T> derivative(const State<T>& x_now, const Joints<T>& tau) const {
    State<T> f = dynamics(robot, x_now, tau);
    if (pushed == Joints<double>{}) return f;
    const Joints<T> pushes = accelerations(mass_matrix(robot, x_now.q[1]), pushed[0], pushed[1]);
    for (std::size_t j = 0; j < kJoints; ++j) f.dq[j] += pushes[j];
    return f;
  }

  static int rhs(sunrealtype t, N_Vector x, N_Vector dx, void* self);
  static int fill_jacobian(sunrealtype t, N_Vector x, N_Vector fx, SUNMatrix j, void* self, N_Vector, N_Vector,
                           N_Vector);
  static int roots(sunrealtype t, N_Vector x, sunrealtype* g, void* self);
};

Rollout::Memory::Memory(const Parameters& p, const Limits& l, const Accuracy& accuracy)
    : robot(p), limits(l), stiff_band{band_of_stiff_friction(p, 0), band_of_stiff_friction(p, 1)} {
  using sundials::check;
  const sundials::Vector absolute(new_vector(context.get()));
  write({{accuracy.position, accuracy.position},
         {accuracy.link_velocity, accuracy.link_velocity},
         {accuracy.position, accuracy.position},
         {accuracy.motor_velocity, accuracy.motor_velocity}},
        absolute.get());
  N_VConst(0.0, x.get());
  for (void* method : {explicit_rk.get(), stiff.get()}) {
    sundials::prepare_arkode(method);
    check(ARKStepSVtolerances(method, accuracy.relative, absolute.get()), "ARKStepSVtolerances");
    check(ARKStepSetUserData(method, this), "ARKStepSetUserData");
    // Cubic Hermite needs no further evaluations, and is what the plan itself is between its rows.
    check(ARKStepSetInterpolantDegree(method, 3), "ARKStepSetInterpolantDegree");
    // The step after a short one, up to the next row, may be as long as the one before.
    check(ARKStepSetMaxGrowth(method, kMostGrowth), "ARKStepSetMaxGrowth");
    // Rows cut steps at will: the errors of those before say nothing about the next.
    check(ARKStepSetAdaptivityMethod(method, ARK_ADAPT_I, 1, 0, nullptr), "ARKStepSetAdaptivityMethod");
    if (!any_watched(limits)) continue;
    check(ARKStepRootInit(method, kRoots, roots), "ARKStepRootInit");
    check(ARKStepSetNoInactiveRootWarn(method), "ARKStepSetNoInactiveRootWarn");  // a motor at rest is at a root
  }
  check(ARKStepSetTableNum(explicit_rk.get(), ARKODE_DIRK_NONE, ARKODE_DORMAND_PRINCE_7_4_5), "ARKStepSetTableNum");
  check(ARKStepSetTableNum(stiff.get(), ARKODE_ARK324L2SA_DIRK_4_2_3, ARKODE_ERK_NONE), "ARKStepSetTableNum");
  check(ARKStepSetLinearSolver(stiff.get(), solver.get(), jacobian.get()), "ARKStepSetLinearSolver");
  check(ARKStepSetJacFn(stiff.get(), fill_jacobian), "ARKStepSetJacFn");
}

Joints<double> Rollout::Memory::torque(double t, const State<double>& x_now) {
  const bool closed = drive.position_gain != Joints<double>{} || drive.velocity_gain != Joints<double>{};
  if (!closed) return plan ? plan->torque_at(t) : drive.held.torque;
  const Sample reference = plan ? plan->at(t) : drive.held;
  const Joints<double> feedback = drive.feedback(reference.state, x_now);
  return {reference.torque[0] + feedback[0] + dither[0], reference.torque[1] + feedback[1] + dither[1]};
}

int Rollout::Memory::rhs(sunrealtype t, N_Vector x, N_Vector dx, void* self) {
  auto& m = *static_cast<Memory*>(self);
  ++m.evaluations;
  const State<double> now = read(x);
  const State<double> f = m.derivative(now, m.torque(t, now));
  write(f, dx);
  return finite(f) ? 0 : 1;  // 1: ARKODE tries again with a smaller step
}

int Rollout::Memory::fill_jacobian(sunrealtype t, N_Vector x, N_Vector, SUNMatrix j, void* self, N_Vector, N_Vector,
                                   N_Vector) {
  auto& m = *static_cast<Memory*>(self);
  const State<double> now = read(x);
  const Joints<double> tau_now = m.torque(t, now);
  State<Active> active;
  for (int i = 0; i < kStates; ++i) active[i] = Active::input(now[i], i);
  Joints<Active> tau;
  for (std::size_t k = 0; k < kJoints; ++k) {
    tau[k] = tau_now[k] - m.drive.position_gain[k] * (active.theta[k] - now.theta[k]) -
             m.drive.velocity_gain[k] * (active.dtheta[k] - now.dtheta[k]);
  }
  const State<Active> f = m.derivative(active, tau);
  for (int column = 0; column < kStates; ++column) {
    sunrealtype* entries = SM_COLUMN_D(j, column);
    for (int row = 0; row < kStates; ++row) entries[row] = f[row].g[static_cast<std::size_t>(column)];
  }
  return 0;
}

int Rollout::Memory::roots(sunrealtype, N_Vector x, sunrealtype* g, void* self) {
  const auto& m = *static_cast<const Memory*>(self);
  const State<double> now = read(x);
  for (std::size_t j = 0; j < kJoints; ++j) g[j] = now.dtheta[j];
  const Joints<double> no_torque{};
  const Moment<double> moment{m.robot, now, no_torque, no_torque};
  sunrealtype* next = g + kReversalRoots;
  Quantities::visit([&](auto quantity) {
    if constexpr (quantity.info.of_robot && !quantity.info.sees_torque) {
      const Joints<double> values = quantity.value(moment);
      for (std::size_t j = 0; j < kJoints; ++j) *next++ = inside(quantity.info.in(m.limits, j), values[j]);
    }
  });
  return 0;
}

void Rollout::Memory::begin(void* method) {
  active = method;
  write(state, x.get());
  const bool explicitly = method == explicit_rk.get();
  sundials::check(ARKStepReInit(method, explicitly ? rhs : nullptr, explicitly ? nullptr : rhs, time, x.get()),
                  "ARKStepReInit");
}

void Rollout::Memory::restart() {
  write(state, x.get());
  sundials::check(ARKStepReset(active, time, x.get()), "ARKStepReset");
}

bool Rollout::Memory::in_stiff_band() const {
  return std::abs(state.dtheta[0]) < stiff_band[0] || std::abs(state.dtheta[1]) < stiff_band[1];
}

// Chooses the explicit or the implicit method for the next step. One-step methods keep no history, so changing costs
// little.
void Rollout::Memory::choose_method(double end) {
  steps_in_band = in_stiff_band() ? steps_in_band + 1 : 0;
  void* wanted = steps_in_band > kStepsOfAPassage ? stiff.get() : explicit_rk.get();
  if (wanted == active) return;
  begin(wanted);
  sundials::check(ARKStepSetStopTime(active, end), "ARKStepSetStopTime");
}

void Rollout::Memory::record_events() {
  std::array<int, kRoots> found{};
  sundials::check(ARKStepGetRootInfo(active, found.data()), "ARKStepGetRootInfo");
  for (int i = 0; i < kRoots; ++i) {
    const int direction = found[static_cast<std::size_t>(i)];
    const bool entering = i >= kReversalRoots && direction > 0;  // coming back inside a limit is no event
    if (direction == 0 || entering) continue;
    if (i < kReversalRoots) events.push_back({time, nullptr, i + 1});
    if (i < kReversalRoots) continue;
    const LimitName& limit = kWatchedLimits[static_cast<std::size_t>(i - kReversalRoots)];
    events.push_back({time, limit.quantity, limit.joint});
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
    sundials::check(ARKStepGetDky(active, at, 0, between.get()), "ARKStepGetDky");
    observe(at, read(between.get()));
  }
}

// Skips a negligible time, in which the state does not change.
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
  if (drive.dither) {
    const Joints<double> next = drive.dither->at((time + end) / 2);
    if (next != std::exchange(dither, next)) restart();
  }
  sundials::check(ARKStepSetStopTime(active, end), "ARKStepSetStopTime");
  bool at_root = false;
  for (; time < end; ++steps) {
    choose_method(end);
    int flag = ARKStepEvolve(active, end, x.get(), &time, ARK_ONE_STEP);
    if (flag == ARK_ILL_INPUT && at_root) {  // ARKODE's own guard: a root function that stays exactly zero after a root
      restart();
      sundials::check(ARKStepSetStopTime(active, end), "ARKStepSetStopTime");
      at_root = false;
      continue;
    }
    state = read(x.get());
    if (flag < 0 || !finite(state) || steps > kMaxSteps) {
      const std::string why = flag < 0        ? flag_name(flag)
                              : finite(state) ? "too many steps"
                                              : "the state is no longer finite";
      failure = "integration stopped at " + std::to_string(time) + " s: " + why;
      return false;
    }
    if (watch) watch(time, state);
    at_root = flag == ARK_ROOT_RETURN;
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
  const bool rests = memory_->in_stiff_band();
  memory_->steps_in_band = rests ? kStepsOfAPassage : 0;
  memory_->begin(rests ? memory_->stiff.get() : memory_->explicit_rk.get());
  redirect(drive);
}

void Rollout::redirect(const Drive& drive) {
  memory_->drive = drive;
  memory_->plan.reset();
  memory_->dither = {};
  if (drive.plan != nullptr) memory_->plan.emplace(*drive.plan);
  memory_->restart();
}

void Rollout::hold(const Joints<double>& torque) {
  memory_->drive.held.torque = torque;
  memory_->restart();
}

void Rollout::push_links(const Joints<double>& torque) {
  memory_->pushed = torque;
  memory_->restart();
}

bool Rollout::run(double end, std::span<const double> instants, std::span<const double> stops,
                  const Observer& observe) {
  std::vector<double> all(stops.begin(), stops.end());
  if (memory_->drive.dither) {
    const std::vector<double>& steps = memory_->drive.dither->steps();
    all.clear();
    std::merge(stops.begin(), stops.end(), steps.begin(), steps.end(), std::back_inserter(all));
  }
  for (const double stop : all) {
    if (stop <= memory_->time) continue;
    if (end - stop < kNegligible) break;
    if (!memory_->run_to(stop, instants, observe)) return false;
  }
  return memory_->run_to(end, instants, observe);
}

void Rollout::watch_steps(Observer observe) { memory_->watch = std::move(observe); }

void Rollout::limit_step(double longest) {
  for (void* method : {memory_->explicit_rk.get(), memory_->stiff.get()}) {
    sundials::check(ARKStepSetMaxStep(method, longest), "ARKStepSetMaxStep");
  }
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

double longest_step(const Trajectory& trajectory) {
  double longest = 0;  // between two rows
  for (std::size_t k = 0; k + 1 < trajectory.samples.size(); ++k) {
    longest = std::max(longest, trajectory.samples[k + 1].time - trajectory.samples[k].time);
  }
  return std::min(longest, kLongestStep);
}

}  // namespace fjr
