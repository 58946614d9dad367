#include "model/identify/pushes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "model/friction.h"
#include "model/identify/checks.h"
#include "model/identify/fit.h"
#include "model/identify/velocity.h"

namespace fjr {
namespace {

constexpr std::size_t kFewestPushRows = 20;
constexpr double kShortestPush = 0.1;  // [s]  shortest push, if there are no commanded ones
constexpr double kConsistentPush = 3;  // accepted ratio to u, or its inverse, since friction may have changed
constexpr double kPushed = 0.1;        // fraction of the largest torque that a push exceeds, if none are commanded

// Returns tau - tau_fm_nonlinear(dtheta), which is u of (26), with the friction known so far.
std::vector<double> compensated_torque(const Log& log, int joint, const Parameters& robot, std::size_t window) {
  const FrictionLaw law = FrictionLaw::of(robot, joint);
  const std::vector<double> v = velocity(log, joint, robot, window).values;
  std::vector<double> u = log.column(joint_column("tau", joint));
  for (std::size_t i = 0; i < u.size(); ++i) u[i] -= law.nonlinear(v[i]);
  return u;
}

}  // namespace

std::vector<Push> pushes(const Log& log, int joint, const Parameters& robot) {
  std::vector<Push> found;
  if (const std::string planned = joint_column("u", joint, "_plan"); log.has(planned)) {
    for (const RowRange& s : commanded_ranges(log.column(planned))) found.push_back({log.column(planned)[s.from], s});
    return found;
  }
  const auto rows = static_cast<std::size_t>(kShortestPush / sample_interval(log));
  const std::vector<double> u = compensated_torque(log, joint, robot, rows / 4);
  double largest = 0;
  for (const RowRange& s : steady_ranges({{u, 0}}, std::max(rows, kFewestPushRows))) {
    found.push_back({robust_mean(std::span(u).subspan(s.from, s.rows())).mean, s});
    largest = std::max(largest, std::abs(found.back().u));
  }
  std::erase_if(found, [&](const Push& push) { return std::abs(push.u) < kPushed * largest; });
  return found;
}

void require_consistent_torque(const Log& log, int joint, const Parameters& robot, const std::vector<Push>& found) {
  const std::string name = joint_column("tau", joint);
  const std::vector<double>& tau = log.column(name);
  if (std::all_of(tau.begin(), tau.end(), [](double t) { return t == 0; })) return;  // not recorded
  const std::vector<double> u = compensated_torque(log, joint, robot, kFewestPushRows);
  std::vector<double> ratios;
  for (const Push& push : found) {
    const std::span<const double> part = std::span(u).subspan(push.rows.from, push.rows.rows());
    ratios.push_back(median({part.begin(), part.end()}) / push.u);
  }
  require_plausible(log, fmt::format("{} less its friction in proportion to u", name), median(ratios), 1,
                    kConsistentPush);
}

}  // namespace fjr
