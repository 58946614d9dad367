// The chain factorisation behind the calling convention that stock Ipopt loads its linear solvers by.
//
// Debian's Ipopt has no headers for a solver of one's own, but it loads MA27 at run time from a library named
// libhsl.so. The library that this file belongs to has that name and those symbols, and is linked into the program: the
// loader finds it already there, and linear_solver = ma27 then means ChainLdlt. The convention has no room for the
// stages, so they are told beforehand.
#pragma once

#include "planner/solver/kkt/chain_ldlt.h"

namespace fjr {

// What the rows of the KKT matrices to come on this thread are, in Ipopt's order: free variables, slacks of the
// inequalities, equality rows, inequality rows.
void describe_chain(ChainStructure structure);

// How many factorisations this thread has done.
int factorisations();

}  // namespace fjr
