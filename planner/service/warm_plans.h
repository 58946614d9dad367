// Earlier plans of one worker, for neighbouring requests to start from. Only minimum-time plans: those have one minimum
// for practical purposes, while with effort in the objective the neighbour's may be far from the best here.
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>

#include "planner/plan.h"

namespace fjr {

class WarmPlans {
 public:
  explicit WarmPlans(std::size_t most) : most_(most) {}

  void remember(const Problem& problem, const Plan& plan) {
    if (most_ == 0 || !plan.solution || !only_fast(problem)) return;
    plans_.push_back({problem, plan.solution});
    if (plans_.size() > most_) plans_.pop_front();
  }

  // The nearest that is near enough; null: none is.
  std::shared_ptr<const Collocated> nearest(const Problem& problem) const {
    std::shared_ptr<const Collocated> found;
    double least = kNear;
    for (const Earlier& earlier : plans_) {
      if (!only_fast(problem) || !comparable(earlier.problem, problem)) continue;
      const double away = distance(earlier.problem, problem);
      if (away > least) continue;
      least = away;
      found = earlier.solution;
    }
    return found;
  }

 private:
  static constexpr double kNear = 0.05;  // [rad] beyond it a warm start takes as long as a cold one
  struct Earlier {
    Problem problem;
    std::shared_ptr<const Collocated> solution;
  };

  static bool only_fast(const Problem& p) {
    return only_time(p.weights) && p.via.empty() && count_of_rows(p.task) == 0 && !p.goal.any_free() &&
           p.other_goals.empty();
  }
  static bool comparable(const Problem& a, const Problem& b) {
    return a.start_at_rest && b.start_at_rest && a.goal.at_rest && b.goal.at_rest && a.duration.min == b.duration.min &&
           a.duration.max == b.duration.max && a.method == b.method && a.limits == b.limits;
  }
  static double distance(const Problem& a, const Problem& b) {
    double largest = 0;
    for (std::size_t j = 0; j < kJoints; ++j) {
      largest = std::max({largest, std::abs(a.start.q[j] - b.start.q[j]), std::abs(a.goal.q[j] - b.goal.q[j])});
    }
    return largest;
  }

  std::size_t most_;
  std::deque<Earlier> plans_;
};

}  // namespace fjr
