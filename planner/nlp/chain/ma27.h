// Offers the chain factorisation through the interface of MA27, as which an unmodified Ipopt can load it.
//
// Debian's Ipopt has no headers to add a linear solver, but it loads MA27 from a library at run time. This file is
// built into a library of its own with the symbols of MA27. When Ipopt is told to load it, linear_solver = ma27 means
// ChainLdlt. The interface of MA27 has no argument for the block structure, so describe_chain() passes it beforehand.
#pragma once

#include <string>

#include "planner/nlp/chain/chain_ldlt.h"

namespace fjr {

// Sets the structure of the KKT matrices that this thread will factorise, with the rows in Ipopt's order: free
// variables, slacks of the inequalities, equality constraints, inequality constraints. `both` runs the two halves of
// the work.
void describe_chain(ChainStructure structure, DoBoth both);

// Returns the number of factorisations that this thread has done.
int factorisations();

// Returns the number of multiplications in these factorisations and their solves, as ChainLdlt counts them.
double multiplications();

// Returns the CPU time [s] that this thread has spent on them.
double chain_seconds();

// Returns the file name of the library that contains this code.
std::string chain_library();

}  // namespace fjr
