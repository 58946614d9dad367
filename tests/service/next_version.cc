// A version of the program that is not there yet, but for this as the one that is.
#include "planner/service/version.h"

namespace fjr {

std::string program_version() { return "1000.0.0"; }

}  // namespace fjr
