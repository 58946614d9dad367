// The chain factorisation behind the calling convention that stock Ipopt loads its linear solvers by.
//
// Debian's Ipopt has no headers for a solver of one's own, but it loads MA27 at run time from a library. This file is
// in a library of its own with those symbols, and linear_solver = ma27 means ChainLdlt when Ipopt was told to load that
// one. The convention has no room for the blocks, so they are told beforehand.
#pragma once

#include <string>

#include "planner/nlp/chain/chain_ldlt.h"

namespace fjr {

// What the rows of the KKT matrices to come on this thread are, in Ipopt's order: free variables, slacks of the
// inequalities, equality rows, inequality rows; and how the halves of the work with them are worked off.
void describe_chain(ChainStructure structure, DoBoth both);

// How many factorisations this thread has done.
int factorisations();

// How many multiplications they and the solves with them took, as ChainLdlt counts them.
double multiplications();

// The CPU time that this thread has spent on them [s].
double chain_seconds();

// File name of the library that this is in.
std::string chain_library();

}  // namespace fjr
