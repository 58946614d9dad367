// RAII for handles of Cyclone DDS, and exceptions that name the call that failed.
#pragma once

#include <dds/dds.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace fjr::dds {

class Error : public std::runtime_error {
 public:
  Error(const std::string& call, dds_return_t code)
      : std::runtime_error("DDS: " + call + ": " + dds_strretcode(-code)), code_(code) {}

  dds_return_t code() const { return code_; }  // DDS_RETCODE_...

 private:
  dds_return_t code_;
};

// Returns the result of a call, or throws if it is an error.
inline dds_return_t checked(dds_return_t returned, const char* call) {
  if (returned < 0) throw Error(call, returned);
  return returned;
}

// Owns one handle. Children are to be destroyed before their parents: declare them after.
class Entity {
 public:
  Entity(dds_entity_t handle, const char* call) : handle_(checked(handle, call)) {}
  ~Entity() {
    if (handle_ > 0) dds_delete(handle_);
  }
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }

  dds_entity_t handle() const { return handle_; }

 private:
  dds_entity_t handle_;
};

}  // namespace fjr::dds
