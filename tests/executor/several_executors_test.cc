// Several executors for one robot, as processes: one of them goes on, and nobody moves while there are two.
#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "planner/dds/wire_execution.h"
#include "planner/dds/writer.h"
#include "planner/protocol/claim.h"
#include "tests/executor/flat_motion.h"
