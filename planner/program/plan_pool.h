// Many requests planned side by side, each by a process of its own.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "planner/batch/items.h"
#include "planner/batch/table.h"
#include "planner/program/plan_process.h"
#include "planner/program/progress_line.h"

namespace fjr {

struct PoolEnd {
  std::vector<std::size_t> not_started;
  bool interrupted;
};

struct PlanPool {
  std::size_t jobs = 1;  // processes at a time
  // Makes a request ready; returns the words behind `fjr plan`. What it throws ends the request in these words.
  std::function<std::vector<std::string>(std::size_t item)> begin;
  // interrupted: it was told to end.
  std::function<void(std::size_t item, const PlanEnding& ending, bool interrupted)> end;

  // In this order, after catch_ending_signals(). At the first of those signals nothing more is started and what is
  // under way is cancelled; at the next it is killed.
  PoolEnd plan(const std::vector<std::size_t>& items, ProgressLine& line) const;
};

// The row of a request by what its process said: its folder may hold earlier results.
Row row_at_end(const BatchItem& item, const PlanEnding& ending, bool interrupted);

}  // namespace fjr
