#include "planner/service/frames.h"

#include <unistd.h>

#include <cerrno>

namespace fjr {
namespace {

constexpr std::uint32_t kLongest = 16 << 20;  // bytes; the rows of the longest trajectory are 2.9 MB

struct Header {
  FrameKind kind;
  std::uint32_t size;
};

bool read_exactly(int descriptor, char* to, std::size_t size) {
  while (size > 0) {
    const ssize_t got = ::read(descriptor, to, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    to += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

bool write_all(int descriptor, const char* from, std::size_t size) {
  while (size > 0) {
    const ssize_t put = ::write(descriptor, from, size);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    from += put;
    size -= static_cast<std::size_t>(put);
  }
  return true;
}

}  // namespace

std::optional<Frame> read_frame(int descriptor) {
  Header header;
  if (!read_exactly(descriptor, reinterpret_cast<char*>(&header), sizeof header)) return std::nullopt;
  if (header.size > kLongest) return std::nullopt;
  Frame frame{header.kind, std::string(header.size, '\0')};
  if (!read_exactly(descriptor, frame.payload.data(), header.size)) return std::nullopt;
  return frame;
}

bool write_frame(int descriptor, FrameKind kind, std::string_view payload) {
  const Header header{kind, static_cast<std::uint32_t>(payload.size())};
  return write_all(descriptor, reinterpret_cast<const char*>(&header), sizeof header) &&
         write_all(descriptor, payload.data(), payload.size());
}

}  // namespace fjr
