#include "common/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <system_error>

namespace fjr {
namespace {

std::runtime_error cannot_write(const std::filesystem::path& file, int error) {
  return std::runtime_error(fmt::format("cannot write {}: {}", file.string(), std::generic_category().message(error)));
}

// Returns 0 or errno. Not std::ofstream: it does not say why it failed.
int write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written >= 0) {
      text.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

// Flushes the folder of a file to the disk, because a rename is on the disk only when the folder is. Returns 0 or
// errno.
int synchronise_folder(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int error = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  return error;
}

void replace(const std::filesystem::path& file, std::string_view text, bool durably) {
  const std::string temporary = temporary_beside(file).string();
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) throw cannot_write(file, errno);
  int error = write_all(descriptor, text);
  if (error == 0 && durably && ::fsync(descriptor) != 0) error = errno;
  if (::close(descriptor) != 0 && error == 0) error = errno;
  if (error == 0 && std::rename(temporary.c_str(), file.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.c_str());
    throw cannot_write(file, error);
  }
  if (durably) error = synchronise_folder(file);
  if (error != 0) throw cannot_write(file, error);
}

}  // namespace

std::filesystem::path temporary_beside(const std::filesystem::path& file) {
  std::random_device random;
  return file.parent_path() / fmt::format(".{}.{:08x}{:08x}.tmp", file.filename().string(), random(), random());
}

void write_file(const std::filesystem::path& file, std::string_view text) { replace(file, text, false); }

void write_file_durably(const std::filesystem::path& file, std::string_view text) { replace(file, text, true); }

}  // namespace fjr
