// Waits until samples arrive or another thread calls wake().
#pragma once

#include <chrono>

#include "planner/dds/entity.h"
#include "planner/dds/participant.h"

namespace fjr::dds {

class Waitset {
 public:
  explicit Waitset(const Participant& participant)
      : guard_(dds_create_guardcondition(participant.handle()), "guard condition"),
        waitset_(dds_create_waitset(participant.handle()), "waitset") {
    attach(guard_.handle());
  }

  void attach(dds_entity_t condition) { checked(dds_waitset_attach(waitset_.handle(), condition, 0), "attach"); }

  void wait(std::chrono::nanoseconds timeout) {
    checked(dds_waitset_wait(waitset_.handle(), nullptr, 0, timeout.count()), "wait");
    bool woken = false;
    checked(dds_take_guardcondition(guard_.handle(), &woken), "guard condition");
  }

  // Ends the current wait or, if there is none, the next one. May be called from any thread.
  void wake() const { dds_set_guardcondition(guard_.handle(), true); }

 private:
  Entity guard_;
  Entity waitset_;
};

}  // namespace fjr::dds
