#include "planner/dds/reach.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <system_error>
#include <utility>
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

// A descriptor, and what identifies its socket: numbers of descriptors are used again.
struct Socket {
  int descriptor;
  std::string identity;
};

std::vector<Socket> sockets() {
  std::vector<Socket> all;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    const int descriptor = std::stoi(entry.path().filename().string());
    std::error_code closed_meanwhile;
    std::string identity = std::filesystem::read_symlink(entry.path(), closed_meanwhile).string();
    // What the process was started with is not DDS.
    if (descriptor > STDERR_FILENO && identity.starts_with("socket:")) all.push_back({descriptor, std::move(identity)});
  }
  return all;
}

class OpenedByDds {
 public:
  void note(const std::set<std::string>& before, bool may_be_joined) {
    const std::lock_guard lock(mutex_);
    bool opened = false;
    for (Socket& socket : sockets()) {
      if (before.contains(socket.identity)) continue;
      opened = true;
      identities_.insert(std::move(socket.identity));
    }
    all_count_ = all_count_ || (may_be_joined && !opened);
  }
  std::vector<Socket> open_now() const {
    std::vector<Socket> all = sockets(), of_dds;
    const std::lock_guard lock(mutex_);
    std::copy_if(all.begin(), all.end(), std::back_inserter(of_dds),
                 [this](const Socket& socket) { return identities_.contains(socket.identity); });
    return all_count_ || of_dds.empty() ? all : of_dds;
  }

 private:
  mutable std::mutex mutex_;
  std::set<std::string> identities_;
  bool all_count_ = false;
};

OpenedByDds& opened_by_dds() {
  static OpenedByDds opened;
  return opened;
}

}  // namespace

std::set<std::string> open_sockets() {
  std::set<std::string> identities;
  for (Socket& socket : sockets()) identities.insert(std::move(socket.identity));
  return identities;
}

void note_opened_by_dds(const std::set<std::string>& before, bool may_be_joined) {
  opened_by_dds().note(before, may_be_joined);
}

bool sends_only_over_loopback() {
  bool loopback = false;
  for (const Socket& socket : opened_by_dds().open_now()) {
    const Bound bound = bound_to(socket.descriptor);
    if (bound == Bound::kNetwork) return false;
    loopback = loopback || bound == Bound::kLoopback;
  }
  return loopback;
}

void hear_only_loopback() {
  constexpr char kLoopback[] = "lo";
  for (const Socket& socket : opened_by_dds().open_now()) {
    if (bound_to(socket.descriptor) != Bound::kAnywhere) continue;
    if (::setsockopt(socket.descriptor, SOL_SOCKET, SO_BINDTODEVICE, kLoopback, sizeof kLoopback) != 0) {
      throw std::system_error(errno, std::generic_category(), "cannot keep DDS to the loopback interface");
    }
  }
}

}  // namespace fjr::dds
