#include "planner/identify/information.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

#include "planner/identify/readings.h"

namespace fjr {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::optional<MotionInformation> information_of(const Parameters& known, const Prior& prior,
                                                const ExecutedMotion& motion, const ForEach& for_each,
                                                const std::function<bool()>& stopped) {
  const std::vector<ExecutedMotion> motions{motion};
  const Readings readings(known, prior, motions, for_each, stopped);
  if (readings.pieces() == 0) return std::nullopt;
  VectorXd x = VectorXd::Zero(readings.unknowns()), off(readings.size());
  MatrixXd slopes(readings.size(), readings.unknowns());
  if (!readings.fit_starts(x) || !readings.fill(x, off, &slopes)) return std::nullopt;
  // At the most likely initial states the score of these is zero. The initial states are eliminated by a Schur
  // complement.
  const Index n = readings.parameters(), starts = readings.unknowns() - n;
  const auto rows = slopes.topRows(readings.readings());
  const auto by_z = rows.leftCols(n), by_start = rows.rightCols(starts);
  const MatrixXd of_starts = by_start.transpose() * by_start + MatrixXd::Identity(starts, starts);
  const MatrixXd mixed = by_start.transpose() * by_z;
  MotionInformation told;
  told.matrix = by_z.transpose() * by_z - mixed.transpose() * of_starts.ldlt().solve(mixed);
  told.score = -by_z.transpose() * off.head(readings.readings());
  const MatrixXd weakly = told.matrix + MatrixXd::Identity(n, n);
  const double explained = told.score.dot(weakly.ldlt().solve(told.score));
  const auto freedom = static_cast<double>(std::max<Index>(1, readings.readings() - n - starts));
  told.chi_square = std::max(0.0, off.head(readings.readings()).squaredNorm() - explained) / freedom;
  told.readings = readings.readings();
  return told;
}

}  // namespace fjr
