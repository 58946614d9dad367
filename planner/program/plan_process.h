// `fjr plan` of one request as a process of its own: Ipopt's MUMPS is not for two threads, and a crash costs one
// request.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "common/descriptor.h"

namespace fjr {

struct PlanEnding {
  std::string words;      // how it ended, for where it has no plan.json to show
  std::string plan_json;  // what it wrote to stdout
};

class PlanProcess {
 public:
  // The words after `fjr plan`. It ends with this process, however that ends.
  explicit PlanProcess(std::vector<std::string> arguments);
  ~PlanProcess();  // kills it
  PlanProcess(PlanProcess&& other) noexcept;
  PlanProcess& operator=(PlanProcess&& other) noexcept;

  std::optional<PlanEnding> ending();  // none while it runs

  void cancel() const;  // it then ends soon, with a plan.json
  void kill() const;

 private:
  pid_t pid_ = -1;  // < 0: has ended
  Descriptor answer_, complaints_;
};

}  // namespace fjr
