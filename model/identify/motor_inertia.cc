// IV-F: from standstill under a constant friction-compensated torque u, (27) gives
//
//   dtheta(t) = u/B (1 - exp(-(t - t0) B/J)),   of initial slope u/J;
//
// all responses are fitted together, each with its own t0, so that a delay before the compensation takes effect does
// not count as inertia. If the velocity is known only from encoder counts, theta is fitted by the integral of this
// response instead of differentiating it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/input_error.h"
#include "model/identify/checks.h"
#include "model/identify/fit.h"
#include "model/identify/procedures.h"
#include "model/identify/pushes.h"
#include "model/identify/responses.h"
#include "model/identify/velocity.h"

namespace fjr {
namespace {

constexpr std::size_t kFewestResponseRows = 20, kFewestResponses = 2;

std::vector<Response> responses(const Log& log, int joint, const Parameters& robot, Measured measured) {
  const std::vector<double>& time = log.column("time");
  const std::vector<double>& y = log.column(joint_column(measured == Measured::kVelocity ? "dtheta" : "theta", joint));
  std::vector<Response> all;
  const std::vector<Push> found = pushes(log, joint, robot);
  std::vector<RowRange> ranges;
  for (const Push& push : found) ranges.push_back(push.rows);
  require_consistent_velocity(log, joint, robot, ranges);
  require_consistent_torque(log, joint, robot, found);
  for (const Push& push : found) {
    if (push.rows.rows() < kFewestResponseRows) continue;
    Response r{push.u, {}, {}};
    const double origin = measured == Measured::kVelocity ? 0 : y[push.rows.from];
    for (std::size_t row = push.rows.from; row < push.rows.to; ++row) {
      r.time.push_back(time[row] - time[push.rows.from]);
      r.y.push_back(y[row] - origin);
    }
    all.push_back(std::move(r));
  }
  if (all.size() < kFewestResponses) {
    throw InputError(log.source, joint_column("u", joint, "_plan"),
                     fmt::format("{} constant torques; at least {} are needed", all.size(), kFewestResponses));
  }
  return all;
}

// Returns the response of dtheta, or of theta relative to its value at t = 0.
double model(Measured measured, double u, double inertia, double viscous, double t) {
  if (t <= 0) return 0;
  const double constant = inertia / viscous, risen = -std::expm1(-t / constant);
  return u / viscous * (measured == Measured::kVelocity ? risen : t - constant * risen);
}

// The parameters are J and B, then t0 of each response and, for positions, its initial value.
class Residual {
 public:
  Residual(Measured measured, const std::vector<Response>& all) : measured_(measured), all_(all) {}

  Eigen::Index size() const {
    Eigen::Index n = 0;
    for (const Response& r : all_) n += static_cast<Eigen::Index>(r.y.size());
    return n;
  }

  Eigen::Index parameters() const {
    return 2 + static_cast<Eigen::Index>(all_.size()) * (measured_ == Measured::kVelocity ? 1 : 2);
  }

  void operator()(const Eigen::VectorXd& p, Eigen::VectorXd& out) const {
    const auto count = static_cast<Eigen::Index>(all_.size());
    Eigen::Index i = 0;
    for (Eigen::Index k = 0; k < count; ++k) {
      const Response& r = all_[static_cast<std::size_t>(k)];
      const double t0 = p[2 + k], began = measured_ == Measured::kVelocity ? 0 : p[2 + count + k];
      for (std::size_t row = 0; row < r.y.size(); ++row) {
        out[i++] = began + model(measured_, r.u, p[0], p[1], r.time[row] - t0) - r.y[row];
      }
    }
  }

 private:
  Measured measured_;
  const std::vector<Response>& all_;
};

// Estimates the final speed u/B and the time constant J/B, after which 1 - 1/e of it is reached.
Eigen::Vector2d from_velocity(const Response& r) {
  const double last = robust_mean(std::span(r.y).last(r.y.size() / 10 + 1)).mean;
  std::size_t row = 0;
  while (row + 1 < r.y.size() && std::abs(r.y[row]) < (1 - std::exp(-1)) * std::abs(last)) ++row;
  return {r.u / last * r.time[row], r.u / last};
}

// Estimates the final speed u/B and the time constant J/B, by which theta lags behind a motion at that speed.
Eigen::Vector2d from_position(const Response& r) {
  const std::size_t n = r.y.size(), late = n - n / 10 - 2;
  const double duration = r.time.back(), last = (r.y.back() - r.y[late]) / (duration - r.time[late]);
  const double constant = std::clamp(duration - r.y.back() / last, 0.02 * duration, duration);
  return {r.u / last * constant, r.u / last};
}

Eigen::VectorXd start(Measured measured, const std::vector<Response>& all) {
  Eigen::VectorXd p = Eigen::VectorXd::Zero(Residual(measured, all).parameters());
  p.head(2) = measured == Measured::kVelocity ? from_velocity(all.back()) : from_position(all.back());
  return p;
}

Fit fit_all(Measured measured, const std::vector<Response>& all, const Eigen::VectorXd& from) {
  const Residual residual(measured, all);
  return curve_fit(residual, residual.size(), from);
}

double largest(const std::vector<Response>& all) {
  double most = 0;
  for (const Response& r : all)
    most = std::max(most, std::abs(median({r.y.end() - kFewestResponseRows / 2, r.y.end()})));
  return most;
}

std::vector<Response> without_outliers(const std::vector<Response>& all, const Fit& fit, double floor) {
  const std::vector<bool> inside =
      inliers({fit.residuals.data(), static_cast<std::size_t>(fit.residuals.size())}, floor);
  std::vector<Response> kept;
  std::size_t i = 0;
  for (const Response& r : all) {
    kept.push_back({r.u, {}, {}});
    for (std::size_t row = 0; row < r.y.size(); ++row, ++i) {
      if (!inside[i]) continue;
      kept.back().time.push_back(r.time[row]);
      kept.back().y.push_back(r.y[row]);
    }
  }
  return kept;
}

double r_squared(const std::vector<Response>& all, const Fit& fit) {
  double square = 0;
  for (const Response& r : all) {
    for (const double y : r.y) square += y * y;
  }
  return 1 - fit.residuals.squaredNorm() / square;
}

}  // namespace

Estimate identify_motor_inertia(const Log& log, int joint, const Parameters& robot) {
  const auto j = static_cast<std::size_t>(joint);
  Estimate e;
  e.names = {"inertia", "viscous"};
  e.units = {"kg m^2", "N m s/rad"};
  warn_of_gaps(log, e.warnings);
  const Measured measured = has_own_velocity(log, joint, robot) ? Measured::kVelocity : Measured::kPosition;
  std::vector<Response> all = responses(log, joint, robot, measured);
  const Eigen::VectorXd from = start(measured, all);
  require_plausible(log, fmt::format("the viscous friction of motor {} [N m s/rad]", joint + 1), from[1],
                    robot.friction.viscous[j]);
  Fit fit = fit_all(measured, all, from);
  all = without_outliers(all, fit, 1e-3 * largest(all));
  const auto rejected = static_cast<std::size_t>(fit.residuals.size() - Residual(measured, all).size());
  warn_of_outliers(rejected, "samples", e.warnings);
  if (rejected > 0) fit = fit_all(measured, all, fit.value);

  allow_for_correlation(fit);

  e.value = fit.value.head(2);
  e.covariance = fit.covariance.topLeftCorner(2, 2);
  e.points = static_cast<std::size_t>(fit.residuals.size());
  e.residual_rms = fit.residual_rms;
  e.residual_unit = measured == Measured::kVelocity ? "rad/s" : "rad";
  e.r_squared = r_squared(all, fit);
  e.fitted = FittedResponses{measured, all, fit.residuals};
  warn_of_doubt(e);
  require_plausible(log, fmt::format("the inertia of motor {} [kg m^2]", joint + 1), e.value[0],
                    robot.motor.inertia[j]);
  return e;
}

}  // namespace fjr
