// Credentials of a participant for DDS Security.
#pragma once

#include <filesystem>

#include "planner/dds/qos.h"

namespace fjr::dds {

// Returns the properties of a participant with the certificates, key and signed documents in `folder`, which has the
// file names of a ROS 2 enclave (config/security/README.md). Throws InputError naming what is missing.
Qos with_credentials(const std::filesystem::path& folder);

}  // namespace fjr::dds
