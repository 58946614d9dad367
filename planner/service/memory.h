// Resident memory of a process.
#pragma once

#include <sys/types.h>

#include <cstdint>

namespace fjr {

std::uint64_t resident_bytes(pid_t process);  // 0 when it is gone

}  // namespace fjr
