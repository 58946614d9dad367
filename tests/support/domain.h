// A DDS domain of one's own: a service on the domain of another test would be that one's standby.
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <string>

namespace fjr {

// 20 to 219, the same for the whole process; other processes of this machine that ask get another one.
inline unsigned own_domain() {
  static const unsigned domain = [] {
    constexpr unsigned kFirst = 20, kCount = 200;
    for (unsigned i = 0; i < kCount; ++i) {
      const unsigned candidate = kFirst + (static_cast<unsigned>(::getpid()) + i) % kCount;
      const auto file = std::filesystem::temp_directory_path() / ("fjr_test_domain_" + std::to_string(candidate));
      const int lock = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);  // held until the process ends
      if (lock < 0) continue;
      if (::flock(lock, LOCK_EX | LOCK_NB) == 0) return candidate;
      ::close(lock);
    }
    throw std::runtime_error("no DDS domain is free");
  }();
  return domain;
}

}  // namespace fjr
