// Preloaded: notes in the file FJR_RECORDED_FILES which files and folders were brought to the disk, and which files
// were renamed, in order: "fsync FILE" (fdatasync, too), "rename FROM TO".
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <climits>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

void note(const std::string& line) {
  const char* name = std::getenv("FJR_RECORDED_FILES");
  if (name == nullptr) return;
  const int file = ::open(name, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (file < 0 || ::write(file, line.data(), line.size()) < 0) return;
  ::close(file);
}

int noted_sync(const char* how, int descriptor) {
  const auto real = reinterpret_cast<int (*)(int)>(::dlsym(RTLD_NEXT, how));
  char name[PATH_MAX] = "";
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  const ssize_t length = ::readlink(link.c_str(), name, sizeof name - 1);
  const int result = real(descriptor);
  if (result == 0 && length > 0) note("fsync " + std::string(name, static_cast<std::size_t>(length)) + "\n");
  return result;
}

}  // namespace

extern "C" {

int fsync(int descriptor) { return noted_sync("fsync", descriptor); }
int fdatasync(int descriptor) { return noted_sync("fdatasync", descriptor); }

int rename(const char* from, const char* to) noexcept {
  static const auto real = reinterpret_cast<int (*)(const char*, const char*)>(::dlsym(RTLD_NEXT, "rename"));
  const int result = real(from, to);
  if (result == 0) note(std::string("rename ") + from + " " + to + "\n");
  return result;
}
}
