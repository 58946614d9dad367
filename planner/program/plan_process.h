// `fjr plan` of one request as a process of its own: Ipopt's MUMPS is not for two threads, and a crash costs one
// request.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/descriptor.h"
#include "common/spawn.h"

namespace fjr {

struct PlanEnding {
  std::string words;      // how it ended, for where it has no plan.json to show
  std::string plan_json;  // what it wrote to stdout
};

class PlanProcess {
 public:
  // The words after `fjr plan`. It ends with this object, and with this process, however that ends.
  explicit PlanProcess(std::vector<std::string> arguments);
  std::optional<PlanEnding> ending();  // none while it runs

  void cancel() const;  // it then ends soon, with a plan.json
  void kill() const;

 private:
  Descriptor answer_, complaints_;
  Child process_;
};

}  // namespace fjr
