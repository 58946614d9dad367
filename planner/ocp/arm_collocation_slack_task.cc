#include "planner/ocp/arm_collocation.h"

namespace fjr {

FJR_ARM_COLLOCATION(, kSlackTask)

}  // namespace fjr
