// Published optimal control problems: what comes out, the published value, how many digits agree, and how many were
// settled: the same on the mesh before.
//   build/bench/published_bench [--json FILE]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>

#include "bench/measure.h"
#include "tests/support/published_problems.h"

namespace fjr::bench {
namespace {

// Leading digits that agree; 0 to 16.
double digits(double value, double reference) {
  const double error = std::abs(value - reference) / std::abs(reference);
  return error < 1e-16 ? 16 : std::max(0.0, -std::log10(error));
}

// `before`: the value on the mesh before, NaN on the first.
Json solved(const std::string& name, const std::string& source, double reference, double before, int intervals,
            const Posed& posed) {
  SolveOptions options;
  options.tolerance = 1e-11;
  const SolveReport report = solve(*posed.nlp, posed.start, options);
  fmt::print("{:<34}{:<20}{:>5}{:>16.10f}{:>14.9g}{:>7.1f}{:>8}{:>6}{:>9.1f}  {}\n", name, source, intervals,
             report.objective, reference, digits(report.objective, reference),
             std::isnan(before) ? "" : fmt::format("{:.1f}", digits(report.objective, before)), report.iterations,
             1e3 * report.cost.total, fjr::name(report.status));
  std::fflush(stdout);
  return {{"problem", name},
          {"source", source},
          {"intervals", intervals},
          {"status", fjr::name(report.status)},
          {"value", report.objective},
          {"reference", reference},
          {"digits", digits(report.objective, reference)},
          {"iterations", report.iterations},
          {"factorisations", report.cost.factorisations},
          {"seconds", report.cost.total}};
}

// True when everything converged.
bool run(const std::vector<int>& meshes, const std::string& json) {
  fmt::print("{:<34}{:<20}{:>5}{:>16}{:>14}{:>7}{:>8}{:>6}{:>9}\n", "problem", "source", "N", "here", "published",
             "digits", "settled", "iter", "ms");
  Json lines = Json::array();
  for (const PublishedProblem& problem : published_problems()) {
    double before = std::nan("");
    for (const int n : meshes) {
      lines.push_back(
          solved(problem.name, problem.source, problem.reference, before, n, problem.pose(hermite_simpson(), n)));
      before = lines.back().at("value");
    }
  }
  double before = std::nan("");
  for (const int n : {2, 5, 10, 20}) {
    lines.push_back(solved("two-link arm, switches as nodes", "Luus 2000, 12.4.2", 2.983, before, 4 * n,
                           minimum_time_two_link_arm_by_arcs(lobatto4(), n)));
    before = lines.back().at("value");
  }
  write_json(json, lines);
  return std::all_of(lines.begin(), lines.end(), [](const Json& line) { return line.at("status") == "optimal"; });
}

}  // namespace
}  // namespace fjr::bench

int main(int argc, char** argv) {
  std::vector<int> meshes{25, 50, 100, 200, 400, 800};
  std::string json;
  CLI::App app("Published optimal control problems through the planner's core");
  app.add_option("--intervals", meshes, "mesh sizes")->check(CLI::Range(2, 100000))->capture_default_str();
  app.add_option("--json", json, "file for the results");
  CLI11_PARSE(app, argc, argv);
  try {
    return fjr::bench::run(meshes, json) ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "published_bench: {}\n", error.what());
    return 1;
  }
}
