// Plans many requests in parallel, each in a process of its own.
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
  // Prepares a request and returns the arguments of `fjr plan`. If it throws, the request ends with that message.
  std::function<std::vector<std::string>(std::size_t item)> begin;
  // Called when a request has ended. interrupted: its process was told to end.
  std::function<void(std::size_t item, const PlanEnding& ending, bool interrupted)> end;

  // Plans the items in this order; catch_ending_signals() has to be called before. At the first of these signals
  // nothing more is started and running plans are cancelled; at the next one they are killed.
  PoolEnd plan(const std::vector<std::size_t>& items, ProgressLine& line) const;
};

// Returns the row of a request from what its process reported, and not from its folder, which may hold earlier results.
Row row_at_end(const BatchItem& item, const PlanEnding& ending, bool interrupted);

}  // namespace fjr
