#include "planner/service/version.h"

namespace fjr {

std::string program_version() { return FJR_VERSION; }

}  // namespace fjr
