// Runs `fjr plan` of one request as a process of its own: Ipopt's MUMPS is not thread-safe, and a crash costs only one
// request.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/descriptor.h"
#include "common/spawn.h"

namespace fjr {

struct PlanEnding {
  std::string words;      // how it ended, if it has no plan.json
  std::string plan_json;  // what it wrote to stdout
};

class PlanProcess {
 public:
  // Starts the process. arguments: those after `fjr plan`. It ends with this object and with the calling process, in
  // whatever way that ends.
  explicit PlanProcess(std::vector<std::string> arguments);
  std::optional<PlanEnding> ending();  // none while it runs

  void cancel() const;  // it then ends soon, with a plan.json
  void kill() const;

 private:
  Descriptor answer_, complaints_;
  Child process_;
};

}  // namespace fjr
