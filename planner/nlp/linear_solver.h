// Where the linear solvers that Ipopt can use come from: MUMPS is in Ipopt, ours is a library beside the program, and
// those of the HSL are in a library that users bring.
#pragma once

#include <string>
#include <vector>

namespace fjr {

// kChainSolver, which is ours, "mumps", and those of the HSL.
const std::vector<std::string>& linear_solvers();

// The library that Ipopt is to load for it: for the HSL's the file that the environment variable FJR_HSL names, or else
// libhsl.so, wherever the dynamic linker finds it. Empty for what is in Ipopt.
std::string library_of(const std::string& linear_solver);

// Why it cannot be had here, as a sentence; empty if it can.
std::string what_is_missing(const std::string& linear_solver);

}  // namespace fjr
