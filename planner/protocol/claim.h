// Decides which of several executors of one robot continues. Two would take the same trajectories, and move two arms or
// fight for one.
#pragma once

#include <array>
#include <cstdint>

namespace fjr {

struct Claimant {
  bool moved = false;                   // has run a trajectory
  bool established = false;             // has looked for other executors, and reports its state
  std::array<std::uint8_t, 16> guid{};  // of its DDS writer of states; unique
};

// Returns whether `mine` gives way to `other`. Of two that see each other exactly one does. An executor that has moved
// never gives way to one that has not, and then an established one never to a newcomer; otherwise the smaller guid
// stays.
inline bool gives_way(const Claimant& mine, const Claimant& other) {
  if (mine.moved != other.moved) return other.moved;
  if (mine.established != other.established) return other.established;
  return other.guid < mine.guid;
}

}  // namespace fjr
