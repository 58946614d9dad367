// Which of several services answers for a robot and publishes its trajectories: exactly one, its owner.
//
// - An owner stays owner while it lives, so that a service that joins takes nothing away from one at work. Without a
// live
//   owner the robot falls to the live instance with the largest hash of robot and instance (rendezvous hashing): all
//   come to the same result without talking about it.
// - Who becomes owner takes an epoch above every epoch seen. Of two owners, as after a pause of the older one, the one
//   with the lower epoch gives up as soon as it hears of the other; until then the executor refuses what it publishes.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

namespace fjr {

class Ownership {
 public:
  Ownership(std::string instance, std::string robot_id);

  // What is known of the others. Epoch 0: owns nothing. Of those who name an epoch that is not believed nothing is.
  void heard(const std::string& instance, const std::string& robot_id, std::uint64_t epoch);
  void lost(const std::string& instance);
  void heard_executor(std::uint64_t epoch);  // the largest that the executor of this robot ran
  bool believes(std::uint64_t epoch) const;  // epoch.h; by the executor's last word, 0 before the first

  // Draws the consequences; true: epoch() has changed.
  bool review();

  std::uint64_t epoch() const { return epoch_; }  // 0: not the owner
  bool owner() const { return epoch_ > 0; }
  bool has_standby() const;  // another live instance for the same robot
  bool alone() const { return peers_.empty(); }
  bool goes_before(const std::string& instance) const;  // where nobody owns the robot yet

  // Whether a request for the robot ("": whichever there is) is to be answered here. What nobody serves is refused by
  // the owner of the first robot of all that are served.
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
