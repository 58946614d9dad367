// What is promised of robust motions, tried: arms drawn from a robot's covariance, others than those by which the tubes
// were found, each rolled out with the executor's law; how many of them keep everything, and stay in the tubes of the
// links.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <string>
#include <thread>
#include <vector>

#include "common/normal.h"
#include "common/parallel.h"
#include "model/encoder.h"
#include "model/uncertainty.h"
#include "planner/certificate/robust/robustness.h"
#include "planner/plan.h"
#include "planner/request/request.h"

namespace fjr::bench {
namespace {

struct Options {
  std::string robot;
  double confidence = 0.99;
  std::size_t arms = 2000;
  std::uint64_t seed = 2;  // the tubes are found with 1
  std::vector<std::string> requests;
};

std::vector<Parameters> draw_arms(const Parameters& robot, const Options& options) {
  const Uncertainty uncertainty = uncertainty_of(robot);
  const Eigen::MatrixXd factor = uncertainty.factor();
  Normal normal(options.seed);
  std::vector<Parameters> arms;
  for (std::size_t n = 0; n < options.arms; ++n) {
    Eigen::VectorXd numbers(factor.cols());
    for (double& number : numbers) number = normal();
    arms.push_back(changed(robot, uncertainty.names, factor * numbers));
  }
  return arms;
}

struct Shares {
  double kept = 0, within = 0, half = 0;
};

Shares try_arms(const Problem& problem, const Plan& plan, const Options& options) {
  const TaskOfMotion task = TaskOfMotion::of(problem.robot, problem.task, plan.segment_ends());
  const std::vector<Parameters> arms = draw_arms(problem.robot, options);
  std::vector<Trial> trials(arms.size());
  for_each_index(arms.size(), static_cast<int>(std::thread::hardware_concurrency()), [&](std::size_t i) {
    trials[i] = try_arm(problem.robot, problem.limits, task, *plan.trajectory, arms[i]);
  });
  const Joints<double>& link = plan.certificate->robustness.link;
  const auto share = [&](const auto& holds) {
    return static_cast<double>(std::count_if(trials.begin(), trials.end(), holds)) / static_cast<double>(arms.size());
  };
  const auto inside = [&](const Trial& t, double part) {
    return t.link[0] <= part * link[0] && t.link[1] <= part * link[1];
  };
  return {share([](const Trial& t) { return t.kept; }), share([&](const Trial& t) { return inside(t, 1); }),
          share([&](const Trial& t) { return inside(t, 0.5); })};
}

void run(const std::string& file, const Options& options) {
  Problem problem = load_request(file, options.robot);
  PlanOptions plan_options;
  plan_options.jobs = 0;
  const Plan ordinary = plan(problem, plan_options);
  problem.robust = options.confidence;
  const Plan robust = plan(problem, plan_options);
  if (!robust.trajectory || !ordinary.trajectory) {
    fmt::print("{:<18} {}\n", problem.name, robust.reason);
    return;
  }
  const Robustness& r = robust.certificate->robustness;
  const double count = count_angle(problem.robot.encoder.link_counts[0]);
  const Shares shares = try_arms(problem, robust, options);
  Plan judged = ordinary;  // by the same tubes
  judged.certificate->robustness = r;
  fmt::print(
      "{:<18} {:<12} {:>9.5g} {:>+8.2f} % {:>6.1f} {:>5.1f}  {:>7.4f} {:>7.4f} {:>7.4f} {:>9.4f}  {}\n", problem.name,
      name(robust.status), robust.objective,
      100 * (robust.objective - ordinary.objective) / std::abs(ordinary.objective), r.link[0] / count,
      r.link[1] / count, shares.kept, shares.within, shares.half, try_arms(problem, judged, options).kept,
      robust.status == PlanStatus::kCertified ? (r.savings.empty() ? "" : r.savings.front().first) : robust.reason);
  std::fflush(stdout);
}

}  // namespace
}  // namespace fjr::bench

int main(int argc, char** argv) {
  fjr::bench::Options options;
  CLI::App app("Motions with margins for uncertain arms, and such arms");
  app.add_option("--robot", options.robot, "Robot file with standard errors or covariance")->required();
  app.add_option("--confidence", options.confidence, "The fraction of arms that is to keep everything");
  app.add_option("--arms", options.arms, "Arms to be tried on each motion");
  app.add_option("--seed", options.seed, "Of their parameters");
  app.add_option("requests", options.requests, "Request files")->required();
  CLI11_PARSE(app, argc, argv);
  fmt::print("{:<18} {:<12} {:>9} {:>10} {:>12}  {:>7} {:>7} {:>7} {:>9}\n", "", "", "objective", "margins", "counts",
             "kept", "within", "half", "ordinary");
  for (const std::string& file : options.requests) {
    try {
      fjr::bench::run(file, options);
    } catch (const std::exception& e) {
      fmt::print("{}: {}\n", file, e.what());
    }
  }
  return 0;
}
