// A folder on this machine for what `fjr plan` writes before it is stored elsewhere; removed with its content.
#pragma once

#include <filesystem>
#include <string>

namespace fjr {

class Scratch {
 public:
  Scratch();  // throws std::system_error
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  std::filesystem::path request(const std::string& name) const { return folder_ / (name + ".yaml"); }
  std::filesystem::path results(const std::string& name) const { return folder_ / name; }
  void clear(const std::string& name) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace fjr
