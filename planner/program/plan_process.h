// `fjr plan` of one request as a process of its own: Ipopt's MUMPS is not for two threads, and a crash costs one
// request.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "planner/service/descriptor.h"

namespace fjr {

class PlanProcess {
 public:
  // The words after `fjr plan`. It ends with this process, however that ends.
  explicit PlanProcess(std::vector<std::string> arguments);
  ~PlanProcess();  // kills it
  PlanProcess(PlanProcess&& other) noexcept;
  PlanProcess& operator=(PlanProcess&& other) noexcept;

  // None while it runs; then how it ended, in words for where it left no plan.json.
  std::optional<std::string> ending();

  void cancel() const;  // it then ends soon, with a plan.json
  void kill() const;

 private:
  pid_t pid_ = -1;  // < 0: has ended
  Descriptor complaints_;
};

}  // namespace fjr
