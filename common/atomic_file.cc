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

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : ".";
}

// Flushes the folder of a file to the disk, because a rename is on the disk only when the folder is. Returns 0 or
// errno.
int synchronise_folder(const std::filesystem::path& file) {
  const int descriptor = ::open(folder_of(file).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int error = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  return error;
}

// Returns 0 or errno.
int write_and_close(int descriptor, std::string_view text, bool durably) {
  int error = write_all(descriptor, text);
  if (error == 0 && durably && ::fsync(descriptor) != 0) error = errno;
  return ::close(descriptor) != 0 && error == 0 ? errno : error;
}

// Writes a file that has no name until it is complete, so that nothing is left behind by a process that is killed.
// Returns false where the file system or the lack of /proc does not allow that, or the disk is full.
bool write_unnamed(const std::string& temporary, std::string_view text) {
  const int descriptor = ::open(folder_of(temporary).c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
  if (descriptor < 0) return false;
  const std::string unnamed = fmt::format("/proc/self/fd/{}", descriptor);
  bool written = write_all(descriptor, text) == 0;
  written = written && ::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, temporary.c_str(), AT_SYMLINK_FOLLOW) == 0;
  return ::close(descriptor) == 0 && written;
}

void replace(const std::filesystem::path& file, std::string_view text, bool durably) {
  const std::string temporary = temporary_beside(file).string();
  int error = 0;
  if (durably || !write_unnamed(temporary, text)) {
    ::unlink(temporary.c_str());
    const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0) throw cannot_write(file, errno);
    error = write_and_close(descriptor, text, durably);
  }
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
