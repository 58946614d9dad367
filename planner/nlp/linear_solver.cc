#include "planner/nlp/linear_solver.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <memory>

#include "planner/nlp/chain/ma27.h"
#include "planner/nlp/solve.h"

namespace fjr {
namespace {

struct HslSolver {
  const char* name;
  const char* symbol;  // a library that contains the solver has this symbol
};

constexpr std::array<HslSolver, 5> kHslSolvers{{{"ma27", "ma27ad_"},
                                                {"ma57", "ma57ad_"},
                                                {"ma77", "ma77_factor_d"},
                                                {"ma86", "ma86_factor_d"},
                                                {"ma97", "ma97_factor_d"}}};

const HslSolver* hsl_solver(const std::string& name) {
  for (const HslSolver& solver : kHslSolvers) {
    if (name == solver.name) return &solver;
  }
  return nullptr;
}

}  // namespace

const std::vector<std::string>& linear_solvers() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{kChainSolver, "mumps"};
    for (const HslSolver& solver : kHslSolvers) all.emplace_back(solver.name);
    return all;
  }();
  return names;
}

std::string library_of(const std::string& linear_solver) {
  if (linear_solver == kChainSolver) return chain_library();
  if (hsl_solver(linear_solver) == nullptr) return "";
  const char* named = std::getenv("FJR_HSL");
  return named != nullptr && *named != '\0' ? named : "libhsl.so";
}

std::string what_is_missing(const std::string& linear_solver) {
  const HslSolver* solver = hsl_solver(linear_solver);
  if (solver == nullptr) return "";
  const std::string file = library_of(linear_solver);
  const std::unique_ptr<void, int (*)(void*)> library(dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL), dlclose);
  if (library == nullptr) {
    return fmt::format(
        "{} is in the HSL library of the user, and {} cannot be loaded ({}); FJR_HSL=/path/to/libhsl.so says where it "
        "is",
        linear_solver, file, dlerror());
  }
  if (dlsym(library.get(), solver->symbol) == nullptr) {
    return fmt::format("{} has no {} (its symbol {} is missing); FJR_HSL names another HSL library", file,
                       linear_solver, solver->symbol);
  }
  return "";
}

}  // namespace fjr
