// Which of the coarse solutions are refined to the end.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

namespace fjr {

struct CoarseSolution {
  double objective;
  int start;  // how many starts had been tried when it was found
};

// Returns for each solution, the best first, whether it is refined. It is if it would be after some number of starts,
// `start` or more: if it is then among the `most(starts)` best, and within this fraction of the best one. What is
// refined with fewer starts is therefore refined with more, so that more starts never give a worse plan. The coarse
// objectives by themselves do not tell which solution is best: 0.1 % apart, they came to 1 % more and less.
inline std::vector<bool> worth_refining(const std::vector<CoarseSolution>& best_first, double within,
                                        const std::function<int(int starts)>& most) {
  int starts = 0;
  for (const CoarseSolution& s : best_first) starts = std::max(starts, s.start);
  std::vector<bool> worth(best_first.size(), false);
  for (int tried = 1; tried <= starts; ++tried) {
    int rank = 0;
    double best = 0;
    for (std::size_t i = 0; i < best_first.size(); ++i) {
      const CoarseSolution& s = best_first[i];
      if (s.start > tried) continue;
      if (rank == 0) best = s.objective;
      if (rank < most(tried) && s.objective <= best + within * std::abs(best)) worth[i] = true;
      ++rank;
    }
  }
  return worth;
}

}  // namespace fjr
