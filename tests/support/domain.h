// A DDS domain of one's own: a service on the domain of another test would be that one's standby.
#pragma once

#include <unistd.h>

#include <stdexcept>
#include <string>

#include "tests/support/named_socket.h"

namespace fjr {

// 20 to 219, the same for the whole process; other processes of this network that ask get another one, also those of
// another build.
inline unsigned own_domain() {
  static const unsigned domain = [] {
    constexpr unsigned kFirst = 20, kCount = 200;
    for (unsigned i = 0; i < kCount; ++i) {
      const unsigned candidate = kFirst + (static_cast<unsigned>(::getpid()) + i) % kCount;
      // The socket stays open until the process ends.
      if (named_socket("fjr_test_domain_" + std::to_string(candidate)) >= 0) return candidate;
    }
    throw std::runtime_error("no DDS domain is free");
  }();
  return domain;
}

}  // namespace fjr
