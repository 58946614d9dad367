// rig.yaml: a virtual rig and how it performs its experiments.
#pragma once

#include <filesystem>

#include "model/rig/experiments.h"
#include "model/rig/rig.h"

namespace fjr {

struct RigSetup {
  Rig rig;
  Experiments experiments;
};

// `setup` with what the file says; every entry may be left out. Throws InputError for unknown keys and for values that
// make no experiment. config/rig.yaml has every key.
void read_rig(const std::filesystem::path& file, RigSetup& setup);

}  // namespace fjr
