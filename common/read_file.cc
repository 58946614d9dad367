#include "common/read_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>

#include "common/descriptor.h"

namespace fjr {

std::optional<std::string> read_file(const std::filesystem::path& file) {
  const auto failure = [&file] {
    return std::runtime_error(fmt::format("cannot read {}: {}", file.string(), std::generic_category().message(errno)));
  };
  const Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (opened.number() < 0 && (errno == ENOENT || errno == ENOTDIR)) return std::nullopt;
  if (opened.number() < 0) throw failure();
  std::string bytes;
  std::array<char, 65536> part{};
  for (;;) {
    const ssize_t read = ::read(opened.number(), part.data(), part.size());
    if (read == 0) return bytes;
    if (read > 0) bytes.append(part.data(), static_cast<std::size_t>(read));
    if (read < 0 && errno != EINTR) throw failure();
  }
}

}  // namespace fjr
