#include "planner/program/commands.h"

namespace fjr {

std::span<const AddCommand> commands() {
  static constexpr AddCommand kPlanning[] = {add_plan, add_verify, add_report, add_keys};
  return kPlanning;
}

}  // namespace fjr
