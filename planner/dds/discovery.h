// Who is there on the domain, and what they write and read, as DDS gets to know it.
#pragma once

#include <array>
#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "planner/dds/participant.h"

namespace fjr::dds {

class Discovery {
 public:
  using Key = std::array<std::uint8_t, 16>;  // of a participant

  struct Peer {
    std::chrono::steady_clock::time_point met = std::chrono::steady_clock::now();
    std::set<std::string> reads, writes;  // topics, of whatever type and quality of service
  };

  explicit Discovery(const Participant& participant);

  // Takes in what is new; true: there was something.
  bool look();

  const std::map<Key, Peer>& peers() const { return peers_; }  // without the participant itself

  double handshakes_may_take() const;  // [s] of those that DDS Security may still be about

  // One sentence on participants that are there and let nothing be seen of them; nothing: there are none. They have no
  // writers and readers, or DDS Security keeps them and this program apart.
  std::optional<std::string> about_strangers() const;

 private:
  std::size_t strangers() const;
  template <class Sample, class Use>
  void take(const Entity& reader, Use use);

  Entity participants_, readers_, writers_;
  Key self_;
  bool secured_;
  std::map<Key, Peer> peers_;
};

}  // namespace fjr::dds
