#include "model/identify/crests.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fjr {
namespace {

constexpr double kSmallest = 0.06;  // fraction of the largest crest; smaller crests are not used

// Returns the top of the parabola through the samples near the highest one. With quantisation, several samples may be
// equally high.
Crest refine(const Curve& curve, std::size_t highest, std::size_t half_width) {
  const std::size_t from = highest > half_width ? highest - half_width : 0;
  const std::size_t to = std::min(highest + half_width + 1, curve.q.size());
  const auto m = static_cast<Eigen::Index>(to - from);
  Eigen::MatrixXd a(m, 3);
  Eigen::VectorXd b(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const std::size_t row = from + static_cast<std::size_t>(i);
    const double t = curve.time[row] - curve.time[highest];
    a.row(i) << 1, t, t * t;
    b[i] = curve.q[row];
  }
  const Eigen::VectorXd p = linear_fit(a, b).value;
  if (!(p[2] < 0)) return {highest, curve.time[highest], curve.q[highest]};
  const double t = -p[1] / (2 * p[2]);
  return {highest, curve.time[highest] + t, p[0] + t * (p[1] + t * p[2])};
}

}  // namespace

std::vector<Crest> crests(const Curve& curve) {
  const double largest = *std::max_element(curve.q.begin(), curve.q.end());
  std::vector<Crest> peaks;
  for (std::size_t row = 0; row < curve.q.size();) {
    const double threshold = 0.25 * (peaks.empty() ? largest : peaks.back().height);
    if (curve.q[row] < threshold) {
      ++row;
      continue;
    }
    std::size_t end = row, highest = row;
    for (; end < curve.q.size() && curve.q[end] >= 0; ++end) {
      if (curve.q[end] > curve.q[highest]) highest = end;
    }
    if (end < curve.q.size()) peaks.push_back(refine(curve, highest, std::max<std::size_t>((end - row) / 8, 2)));
    if (!peaks.empty() && peaks.back().height < kSmallest * largest) break;
    row = end + 1;
  }
  return peaks;
}

Fit decrement_line(const std::vector<Crest>& all) {
  const auto m = static_cast<Eigen::Index>(all.size());
  Eigen::MatrixXd a(m, 2);
  Eigen::VectorXd logarithm(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Crest& crest = all[static_cast<std::size_t>(i)];
    a.row(i) << 1, crest.time;
    logarithm[i] = std::log(crest.height);
  }
  return linear_fit(a, logarithm);
}

Decrement decrement(const std::vector<Crest>& all) {
  const auto m = static_cast<Eigen::Index>(all.size());
  Eigen::MatrixXd line(m, 2);
  Eigen::VectorXd time(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    line.row(i) << 1, static_cast<double>(i);
    time[i] = all[static_cast<std::size_t>(i)].time;
  }
  const double sigma = -decrement_line(all).value[1];  // zeta omega_s (13)
  const double omega = 2 * std::numbers::pi / linear_fit(line, time).value[1];
  return {omega * omega + sigma * sigma, 2 * sigma};
}

}  // namespace fjr
