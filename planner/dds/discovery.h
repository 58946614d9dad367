// The participants on the domain, and the topics they write and read, as DDS discovers them.
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

  // Processes new discovery data; returns whether there was any.
  bool look();

  const std::map<Key, Peer>& peers() const { return peers_; }  // without the participant itself

  double handshakes_may_take() const;  // [s] that pending handshakes of DDS Security may take

  // Returns a sentence about participants of which no endpoints are visible, or nothing if there are none. They have no
  // writers and readers, or DDS Security separates them from this program.
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
