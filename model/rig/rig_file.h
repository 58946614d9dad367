// Reads rig.yaml: a virtual rig and the settings of its experiments.
#pragma once

#include <filesystem>

#include "model/rig/experiments.h"
#include "model/rig/rig.h"

namespace fjr {

struct RigSetup {
  Rig rig;
  Experiments experiments;
};

// Overwrites entries of `setup` by those in the file; all are optional. Throws InputError for unknown keys and for
// values with which no experiment is possible. config/rig.yaml contains every key.
void read_rig(const std::filesystem::path& file, RigSetup& setup);

}  // namespace fjr
