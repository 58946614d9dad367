// The linear solvers that Ipopt can use: MUMPS is part of Ipopt, the chain factorisation is a library beside the
// program, and the HSL solvers come from a library that the user provides.
#pragma once

#include <string>
#include <vector>

namespace fjr {

// Returns the names: kChainSolver, "mumps", and those of the HSL solvers.
const std::vector<std::string>& linear_solvers();

// Returns the library that Ipopt must load for a solver, empty if the solver is part of Ipopt. For an HSL solver it is
// the file named by the environment variable FJR_HSL, or else libhsl.so, which the dynamic linker searches.
std::string library_of(const std::string& linear_solver);

// Returns a sentence why the solver is not available here; empty if it is available.
std::string what_is_missing(const std::string& linear_solver);

}  // namespace fjr
