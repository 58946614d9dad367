// Decides which one of several services is the owner of a robot: the one that answers its requests and publishes its
// trajectories.
//
// - An owner stays owner while it lives, so that a service that joins does not interrupt one at work. Without a live
//   owner, the live instance with the largest hash of robot and instance becomes owner (rendezvous hashing), so that
//   all instances come to the same result without an election.
// - A new owner takes an epoch above every epoch seen. If there are two owners, as after a pause of the older one, the
//   one with the lower epoch resigns as soon as it hears of the other. Until then the executor refuses its
//   trajectories.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

namespace fjr {

class Ownership {
 public:
  Ownership(std::string instance, std::string robot_id);

  // Takes the status of another instance. Epoch 0 means that it is not an owner. Instances with an epoch that is not
  // believed are ignored.
  void heard(const std::string& instance, const std::string& robot_id, std::uint64_t epoch);
  void lost(const std::string& instance);
  void heard_executor(std::uint64_t epoch);  // the largest epoch that the executor of this robot has run
  bool believes(std::uint64_t epoch) const;  // epoch.h; by the executor's last word, 0 before the first

  // Takes or gives up the ownership if necessary. Returns whether epoch() has changed.
  bool review();

  std::uint64_t epoch() const { return epoch_; }  // 0: not the owner
  bool owner() const { return epoch_ > 0; }
  bool has_standby() const;  // another live instance for the same robot
  bool alone() const { return peers_.empty(); }
  bool goes_before(const std::string& instance) const;  // precedence over another instance while there is no owner

  // Returns whether a request for the robot ("" means any) should be answered here. Requests for robots that nobody
  // serves are refused by the owner of the first of all served robots.
  bool answers_for(const std::string& robot_id) const;
  std::set<std::string> robots() const;  // served by anybody

 private:
  struct Peer {
    std::string robot_id;
    std::uint64_t epoch = 0;
  };

  void forget_what_is_not_believed();
  bool outranked() const;
  bool somebody_owns() const;
  bool first_in_line() const;

  const std::string instance_, robot_id_;
  std::map<std::string, Peer> peers_;
  std::uint64_t epoch_ = 0, largest_ = 0, executor_ = 0;  // largest_: of all that are believed
};

}  // namespace fjr
