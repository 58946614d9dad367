// Which of several executors of one robot goes on. Two would take the same trajectories, and move two arms or fight for
// one.
#pragma once

#include <array>
#include <cstdint>

namespace fjr {

struct Claimant {
  bool moved = false;                   // has run a trajectory
  bool established = false;             // has looked for others, and reports its state
  std::array<std::uint8_t, 16> guid{};  // of its writer of states on DDS: different for all
};

// Whether `mine` gives way to `other`. Of two that see each other exactly one does: nobody who has moved is sent away
// by one who has not, nor who is established by a newcomer; otherwise the smaller guid stays.
inline bool gives_way(const Claimant& mine, const Claimant& other) {
  if (mine.moved != other.moved) return other.moved;
  if (mine.established != other.established) return other.established;
  return other.guid < mine.guid;
}

}  // namespace fjr
