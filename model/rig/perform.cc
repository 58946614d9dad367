#include <fmt/format.h>

#include <optional>
#include <stdexcept>
#include <utility>

#include "model/rig/experiments.h"

namespace fjr {

std::vector<std::string> experiment_names() {
  std::vector<std::string> names;
  const Experiments all;
  visit_experiments(all, [&](const ExperimentInfo& info, const auto&, auto&&) { names.emplace_back(info.name); });
  return names;
}

Record perform(const std::string& name, const Rig& rig, int joint, const Experiments& experiments,
               const RigProgress& progress) {
  std::optional<Record> record;
  visit_experiments(experiments, [&](const ExperimentInfo& info, const auto& how, auto&& perform_it) {
    if (info.name == name) record = perform_it(rig, joint, how[static_cast<std::size_t>(joint)], progress);
  });
  if (!record) throw std::invalid_argument("no experiment is named " + name);
  record->metadata["experiment"] = name;
  record->metadata["joint"] = fmt::format("{}", joint + 1);
  return *std::move(record);
}

}  // namespace fjr
