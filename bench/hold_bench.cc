// How closely the executor's control law follows trajectories and holds the arm after them, with its ticks and the
// counts of the encoders: on the model, and on arms that are not quite the model.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <functional>

#include "planner/certificate/residual.h"
#include "planner/certificate/rollout.h"
#include "planner/control/motor_feedback.h"

namespace fjr::bench {
namespace {

constexpr double kHeld = 1.5, kSettling = 0.5;  // [s] after the end

struct Errors {  // of the links, in counts of their encoders
  double motion = 0, after = 0, settled = 0;
};

Trajectory with_rest(const Parameters& p, Trajectory plan) {
  const Joints<double> goal = plan.samples.back().state.q;
  plan.samples.push_back({plan.end_time() + kJumpSpacing, rest_at(p, goal), gravity_torque(p, goal)});
  return plan;
}

Errors run(const Parameters& p, const Parameters& truth, const Trajectory& published) {
  const Trajectory plan = with_rest(p, published);
  TickController controller(p, plan);
  Interpolator wanted(plan);
  Rollout arm(truth, Limits{}, Accuracy::of_predictions());
  arm.limit_step(kLongestStep);
  arm.start(plan.start_time(), plan.samples.front().state, Drive::holding(plan.samples.front()));
  Errors errors;
  while (arm.time() < published.end_time() + kHeld) {
    const double now = arm.time();
    arm.hold(controller.command(now, {arm.state().theta, arm.state().q}).torque);
    if (!arm.run(now + kTick, {}, {}, {})) throw std::runtime_error(arm.failure());
    const State<double> planned = wanted.at(arm.time()).state;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double error = std::abs(arm.state().q[j] - planned.q[j]) / count_angle(p.encoder.link_counts[j]);
      double& largest = arm.time() <= published.end_time() ? errors.motion : errors.after;
      largest = std::max(largest, error);
      if (now > published.end_time() + kSettling) errors.settled = std::max(errors.settled, error);
    }
  }
  return errors;
}

std::string statistics(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return fmt::format("{:8.2f} {:8.2f} {:8.2f}", values[values.size() / 2], values[values.size() * 9 / 10],
                     values.back());
}

void scale(Joints<double>& values, double by) {
  for (double& value : values) value *= by;
}

struct Arm {
  const char* name;
  std::function<void(Parameters&)> change;
};
const Arm kArms[] = {
    {"the model", [](Parameters&) {}},
    {"friction's amplitudes + 20 %", [](Parameters& p) { scale(p.friction.amplitude, 1.2); }},
    {"friction's widths - 30 %", [](Parameters& p) { scale(p.friction.width, 0.7); }},
    {"inertias of the links + 5 %", [](Parameters& p) { scale(p.link.inertia, 1.05); }},
    {"stiffness + 5 %", [](Parameters& p) { scale(p.spring.stiffness, 1.05); }},
    {"30 g at the tip", [](Parameters& p) { p.payload.mass = 0.03; }},
};

}  // namespace
}  // namespace fjr::bench

int main(int argc, char** argv) {
  using namespace fjr;
  using namespace fjr::bench;
  CLI::App app{"Link errors under the executor's control law, in counts: median, nine tenths, largest"};
  std::vector<std::string> files;
  app.add_option("TRAJECTORY", files, "trajectory.csv files of the shipped robot; those that end moving are left out")
      ->required();
  CLI11_PARSE(app, argc, argv);
  const Parameters robot = load_parameters(default_robot_file());
  std::vector<Trajectory> plans;
  for (const std::string& file : files) {
    Trajectory plan = read_csv(file);
    if (is_at_rest(robot, plan.samples.back())) plans.push_back(std::move(plan));
  }
  if (plans.empty()) throw std::runtime_error("none of these ends at rest");
  fmt::print("{:30} {:>26} {:>26} {:>26}\n", fmt::format("{} trajectories", plans.size()), "motion",
             fmt::format("{} s after", kHeld), fmt::format("of it after {} s", kSettling));
  for (const Arm& arm : kArms) {
    Parameters truth = robot;
    arm.change(truth);
    std::vector<double> motion, after, settled;
    for (const Trajectory& plan : plans) {
      const Errors errors = run(robot, truth, plan);
      motion.push_back(errors.motion);
      after.push_back(errors.after);
      settled.push_back(errors.settled);
    }
    fmt::print("{:30} {} {} {}\n", arm.name, statistics(motion), statistics(after), statistics(settled));
  }
}
