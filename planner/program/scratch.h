// A folder on this machine for what `fjr plan` writes before it is stored elsewhere; removed with its content. A
// process that is killed leaves its folder behind, and the next one that makes such a folder removes it.
#pragma once

#include <filesystem>
#include <string>

#include "common/descriptor.h"

namespace fjr {

class Scratch {
 public:
  Scratch();  // throws std::system_error
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  // Folders of their own, for a request may be called like anything.
  std::filesystem::path request(const std::string& name) const { return folder_ / "requests" / (name + ".yaml"); }
  std::filesystem::path results(const std::string& name) const { return folder_ / "results" / name; }
  void clear(const std::string& name) const;

 private:
  std::filesystem::path folder_;
  Descriptor lock_;  // held as long as the process lives
};

}  // namespace fjr
