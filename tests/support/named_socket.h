// A socket whose name is in no folder. The kernel gives the name to one process of this network namespace and forgets
// it with that process: nothing is left behind, and it does not matter how long the names of folders are.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <string>

namespace fjr {

// A descriptor for datagrams; -1: another process has the name.
inline int named_socket(const std::string& name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::size_t letters = name.copy(address.sun_path + 1, sizeof address.sun_path - 1);  // the 0 in front: no path
  const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + letters);
  if (::bind(socket, reinterpret_cast<const sockaddr*>(&address), size) == 0) return socket;
  ::close(socket);
  return -1;
}

}  // namespace fjr
