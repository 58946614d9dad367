#include "planner/program/scratch.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <system_error>

#include "common/host_name.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScratchPrefix = "fjr-batch-";

// The file has the name of the machine, because some file systems that machines share do not share locks: there a
// folder of another machine would look as if nobody used it.
fs::path lock_file(const fs::path& folder) { return folder / ("lock." + host_name()); }

// The file is locked before it gets its name, so that one that nobody holds is one whose process has ended. Where there
// are no locks it does not get the name, and the folder is never taken for one that was left behind.
Descriptor take_lock(const fs::path& folder) {
  const fs::path unnamed = folder / "new";
  Descriptor file(::open(unnamed.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  if (file.number() >= 0 && ::flock(file.number(), LOCK_EX | LOCK_NB) == 0) {
    std::rename(unnamed.c_str(), lock_file(folder).c_str());
  }
  return file;
}

// The file of the lock goes last, so that the next process removes what a kill leaves of this. It is closed before: NFS
// keeps a file that is open under another name, and with it the folder.
void remove_folder(const fs::path& folder, Descriptor& lock) {
  std::error_code error;
  for (const char* part : {"requests", "results"}) fs::remove_all(folder / part, error);
  lock.reset();
  fs::remove_all(folder, error);
}

void remove_if_left_behind(const fs::path& folder) {
  struct stat about = {};
  if (::lstat(folder.c_str(), &about) != 0 || !S_ISDIR(about.st_mode) || about.st_uid != ::geteuid()) return;
  Descriptor file(::open(lock_file(folder).c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (file.number() < 0 || ::flock(file.number(), LOCK_EX | LOCK_NB) != 0) return;
  // It has no name any more where another process has removed the folder since it was opened.
  if (::fstat(file.number(), &about) == 0 && about.st_nlink > 0) remove_folder(folder, file);
}

void remove_what_was_left_behind(const fs::path& parent) {
  std::error_code error;
  for (fs::directory_iterator entry(parent, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().filename().string().starts_with(kScratchPrefix)) remove_if_left_behind(entry->path());
  }
}

}  // namespace

Scratch::Scratch() {
  const fs::path parent = fs::temp_directory_path();
  remove_what_was_left_behind(parent);
  std::string name = (parent / kScratchPrefix).string() + "XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) {
    throw std::system_error(errno, std::generic_category(), "cannot make a folder " + name);
  }
  folder_ = name;
  lock_ = take_lock(folder_);
  for (const char* part : {"requests", "results"}) fs::create_directory(folder_ / part);
}

Scratch::~Scratch() { remove_folder(folder_, lock_); }

void Scratch::clear(const std::string& name) const {
  std::error_code error;
  fs::remove_all(results(name), error);
  fs::remove(request(name), error);
}

}  // namespace fjr
