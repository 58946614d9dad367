// From what a start came to on a coarse mesh, to the end.
#pragma once

#include <memory>
#include <string>

#include "planner/search/findings.h"

namespace fjr {

// [s] Coarse meshes of longer motions do not resolve how the springs swing.
inline constexpr double kLongMotion = 8;

// Notes a motion that was found on a coarse mesh, and refines and publishes it if it promises something: the best
// certified one is the plan. While nothing is certified, everything is worth it.
void follow(Continuation c, Findings& found, Session& session);

// Solves an alternative from this guess on a coarse mesh, and follows what it comes to. False when that is no solution,
// known or new.
bool try_start(const std::shared_ptr<const Problem>& alternative, const Guess& guess, const std::string& label,
               Findings& found, Session& session);

}  // namespace fjr
