// What whoever solves several neighbouring problems needs of the plan it is for.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "planner/problem/problem.h"

namespace fjr {

class Continuation;
struct Guess;

struct SolveTools {
  std::function<Continuation(const Problem&, const std::string& label)> continuation;  // the problem outlives it
  std::function<std::vector<Guess>(const Problem&)> guesses;
  std::function<void(const Continuation&)> book;  // its work is done
  std::function<bool()> interrupted;
};

}  // namespace fjr
