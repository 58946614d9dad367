#include <stdexcept>

#include "common/library_folder.h"
#include "planner/program/commands.h"

namespace fjr {

std::span<const AddCommand> commands() { return kPlanningCommands; }

std::filesystem::path complete_program() {
  const std::filesystem::path folder = library_folder();
  if (folder.empty()) throw std::runtime_error("cannot find the folder of libfjr_folder.so");
  return folder / "fjr";
}

}  // namespace fjr
