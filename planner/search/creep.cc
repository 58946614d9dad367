#include "planner/search/creep.h"

#include <cmath>
#include <optional>

#include "model/friction.h"
#include "planner/trajectory/motion.h"

namespace fjr {
namespace {

bool rests(const Motion& motion, std::size_t interval, std::size_t joint, double band, int probes) {
  const auto& i = motion.intervals[interval];
  for (int p = 0; p <= probes; ++p) {
    const State<double> x = motion.state_in(interval, i.start + i.duration * p / probes);
    if (std::abs(x.dtheta[joint]) > band) return false;
  }
  return true;
}

}  // namespace

std::vector<Joints<double>> creep_through_rests(const Problem& problem, const Motion& motion,
                                                const CreepSettings& settings) {
  const std::size_t count = motion.intervals.size();
  std::vector<Joints<double>> creep(count, {0, 0});
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double band = FrictionLaw::of(problem.robot, static_cast<int>(j)).unstable_band();
    if (band == 0 || !std::isfinite(band)) continue;
    // In the first and the last interval the motor has to leave the start and to come to rest at the goal.
    for (std::size_t first = 1; first + 1 < count; ++first) {
      std::size_t end = first;
      while (end + 1 < count && rests(motion, end, j, band, settings.probes)) ++end;
      if (end == first) continue;
      const double from = motion.intervals[first].start, to = motion.intervals[end].start;
      const std::optional<Pause>& pause = problem.variation.pause;
      if (pause && to > pause->begin && from < pause->end) {  // its motors are to be slower than creeping ones
        first = end;
        continue;
      }
      if (to - from >= settings.shortest_rest) {
        const double moved = motion.state_at(to).theta[j] - motion.state_at(from).theta[j];
        for (std::size_t k = first; k < end; ++k) creep[k][j] = std::copysign(settings.faster * band, moved);
      }
      first = end;
    }
  }
  return creep;
}

}  // namespace fjr
