// Plans the fastest motion to (1.2, -0.8) rad and writes it to reach.csv.
#include <iostream>

#include "common/input_error.h"
#include "planner/plan.h"
#include "planner/request/request.h"

int main() {
  try {
    const fjr::Parameters robot = fjr::load_parameters(fjr::default_robot_file());

    fjr::Request request;
    request.source = "reach";
    request.start.emplace().q = {0, 0};
    request.goal = fjr::JointGoal{{1.2, -0.8}, fjr::AtRest{}};
    request.objective = fjr::Preset::kFastest;
    request.limits.torque = {10, 5};

    fjr::PlanOptions options;
    options.jobs = 0;  // all cores
    const fjr::Plan plan = fjr::plan(fjr::resolve(request, robot), options);
    if (plan.status != fjr::PlanStatus::kCertified) {
      std::cerr << fjr::name(plan.status) << ": " << plan.reason << '\n';
      return fjr::exit_code(plan.status);
    }
    std::cout << "certified, " << plan.duration << " s\n";
    fjr::write_csv(*plan.trajectory, "reach.csv");

    fjr::Interpolator motion(*plan.trajectory);
    const fjr::Sample half = motion.at(plan.duration / 2);
    std::cout << "half way q = " << half.state.q[0] << ", " << half.state.q[1] << " rad\n";
    return 0;
  } catch (const fjr::InputError& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
