#include "planner/program/scratch.h"

#include <cerrno>
#include <cstdlib>
#include <system_error>

namespace fjr {

namespace fs = std::filesystem;

Scratch::Scratch() {
  std::string name = (fs::temp_directory_path() / "fjr-batch-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw std::system_error(errno, std::generic_category(), "cannot make a folder " + name);
  }
  folder_ = name;
}

Scratch::~Scratch() {
  std::error_code error;
  fs::remove_all(folder_, error);
}

void Scratch::clear(const std::string& name) const {
  std::error_code error;
  fs::remove_all(results(name), error);
  fs::remove(request(name), error);
}

}  // namespace fjr
