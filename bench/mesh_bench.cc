// One optimisation of a request on uniform meshes from its first guess: what an iteration costs by mesh size, with the
// chain factorisation and with MUMPS.
//   build/bench/mesh_bench REQUEST.yaml... [--intervals 25 50 ...] [--linear-solver stage mumps] [--json FILE]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>

#include "bench/measure.h"
#include "model/parameters.h"
#include "planner/ocp/collocate.h"
#include "planner/request/request.h"
#include "planner/search/guesses.h"

namespace fjr::bench {
namespace {

struct Options {
  std::vector<std::string> requests;
  std::vector<int> intervals{25, 50, 100, 200, 400, 800};
  std::vector<std::string> linear_solvers{"stage", "mumps"};
  int repetitions = 3;
  int iterations = 100;
  std::string json;
};

// The friction law of a cold start: see usual_strategy() in planner/search/continuation_strategy.cc.
SolveReport solve_once(const Problem& problem, int intervals, const std::string& linear_solver, int iterations) {
  SolveOptions options;
  options.linear_solver = linear_solver;
  options.max_iterations = iterations;
  const Guess guess = straight_guess(problem, duration_guess(problem));
  const CollocationSetup setup{hermite_simpson(), uniform_mesh(guess.durations, intervals), {0.1, 0.1}};
  return collocate(problem, setup, guess, options).report;
}

Json measure(const Problem& problem, int intervals, const std::string& linear_solver, const Options& options) {
  std::vector<double> per_iteration;
  SolveReport report;
  for (int i = 0; i < options.repetitions; ++i) {
    report = solve_once(problem, intervals, linear_solver, options.iterations);
    per_iteration.push_back(report.cost.total / std::max(report.iterations, 1));
  }
  const Spread s = spread(per_iteration);
  return {{"request", problem.name},
          {"intervals", intervals},
          {"linear_solver", linear_solver},
          {"status", name(report.status)},
          {"iterations", report.iterations},
          {"factorisations", report.cost.factorisations},
          {"per_iteration", s.median},
          {"per_iteration_min", s.least},
          {"per_iteration_max", s.largest},
          {"linear_algebra_per_iteration", report.cost.linear_algebra / std::max(report.iterations, 1)},
          {"shares", shares(report.cost)}};
}

void print(const Json& line) {
  const Json& part = line.at("shares");
  const auto percent = [&](const char* of) { return 100 * part.at(of).get<double>(); };
  fmt::print("{:<18}{:>5} {:<6}{:>6} {:<16}{:>9.3f}{:>9.3f}{:>9.3f}{:>8.2f}{:>6.0f}{:>6.0f}{:>6.0f}\n",
             line.at("request").get<std::string>(), line.at("intervals").get<int>(),
             line.at("linear_solver").get<std::string>(), line.at("iterations").get<int>(),
             line.at("status").get<std::string>(), 1e3 * line.at("per_iteration").get<double>(),
             1e3 * line.at("per_iteration_min").get<double>(), 1e3 * line.at("per_iteration_max").get<double>(),
             1e6 * line.at("per_iteration").get<double>() / line.at("intervals").get<int>(), percent("evaluation"),
             percent("linear_algebra"), percent("ipopt"));
  std::fflush(stdout);
}

void run(const Options& options) {
  fmt::print("{:<18}{:>5} {:<6}{:>6} {:<16}{:>9}{:>9}{:>9}{:>8}{:>6}{:>6}{:>6}\n", "request", "N", "linear", "iter",
             "status", "ms/iter", "min", "max", "us/N", "eval%", "lin%", "Ipopt%");
  Json lines = Json::array();
  for (const std::string& request : options.requests) {
    const Problem problem = load_request(request, default_robot_file());
    for (const int intervals : options.intervals) {
      for (const std::string& linear_solver : options.linear_solvers) {
        lines.push_back(measure(problem, intervals, linear_solver, options));
        print(lines.back());
      }
    }
  }
  write_json(options.json, lines);
}

}  // namespace
}  // namespace fjr::bench

int main(int argc, char** argv) {
  fjr::bench::Options options;
  CLI::App app("Time per iteration against the size of the mesh");
  app.add_option("requests", options.requests, "request files")->required()->check(CLI::ExistingFile);
  app.add_option("--intervals", options.intervals, "mesh sizes")->check(CLI::Range(2, 100000))->capture_default_str();
  app.add_option("--linear-solver", options.linear_solvers, "stage, mumps")->capture_default_str();
  app.add_option("--repetitions", options.repetitions)->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_option("--iterations", options.iterations, "of the optimiser, at most")->check(CLI::Range(1, 10000));
  app.add_option("--json", options.json, "file for the results");
  CLI11_PARSE(app, argc, argv);
  try {
    fjr::bench::run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "mesh_bench: {}\n", error.what());
    return 1;
  }
  return 0;
}
