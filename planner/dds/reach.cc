#include "planner/dds/reach.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace fjr::dds {
namespace {

enum class Bound { kNothing, kAnywhere, kLoopback, kNetwork };

Bound bound_to(in_addr_t address) {
  if (address == INADDR_ANY) return Bound::kAnywhere;
  return address >> 24U == IN_LOOPBACKNET ? Bound::kLoopback : Bound::kNetwork;
}

Bound bound_to(const in6_addr& address) {
  if (IN6_IS_ADDR_UNSPECIFIED(&address)) return Bound::kAnywhere;
  return IN6_IS_ADDR_LOOPBACK(&address) ? Bound::kLoopback : Bound::kNetwork;
}

Bound bound_to(int descriptor) {
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  if (::getsockname(descriptor, reinterpret_cast<sockaddr*>(&name), &size) != 0) return Bound::kNothing;
  switch (name.ss_family) {
    case AF_UNIX:
    case AF_NETLINK:
      return Bound::kNothing;
    case AF_INET:
      return bound_to(ntohl(reinterpret_cast<const sockaddr_in&>(name).sin_addr.s_addr));
    case AF_INET6:
      return bound_to(reinterpret_cast<const sockaddr_in6&>(name).sin6_addr);
    default:
      return Bound::kNetwork;  // raw Ethernet, for one
  }
}

std::vector<int> open_descriptors() {
  std::vector<int> descriptors;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    const int descriptor = std::stoi(entry.path().filename().string());
    if (descriptor > STDERR_FILENO) descriptors.push_back(descriptor);  // what the process was started with is not DDS
  }
  return descriptors;
}

}  // namespace

bool sends_only_over_loopback() {
  bool loopback = false;
  for (const int descriptor : open_descriptors()) {
    const Bound bound = bound_to(descriptor);
    if (bound == Bound::kNetwork) return false;
    loopback = loopback || bound == Bound::kLoopback;
  }
  return loopback;
}

void hear_only_loopback() {
  constexpr char kLoopback[] = "lo";
  for (const int descriptor : open_descriptors()) {
    if (bound_to(descriptor) != Bound::kAnywhere) continue;
    if (::setsockopt(descriptor, SOL_SOCKET, SO_BINDTODEVICE, kLoopback, sizeof kLoopback) != 0) {
      throw std::system_error(errno, std::generic_category(), "cannot keep DDS to the loopback interface");
    }
  }
}

}  // namespace fjr::dds
