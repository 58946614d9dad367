// IV-F: from standstill under a constant friction-compensated torque u, (27) gives
//
//   dtheta(t) = u/B (1 - exp(-(t - t0) B/J)),   of initial slope u/J;
//
// all responses are fitted together, each with its own t0: what is lost before the compensation gets hold is no
// inertia.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/identify/checks.h"
#include "model/identify/fit.h"
#include "model/identify/procedures.h"
#include "model/input_error.h"

namespace fjr {
namespace {

struct Response {
  double u;                     // [N m]
  std::vector<double> time, v;  // since u was switched on
};

constexpr std::size_t kFewestRows = 20, kFewestResponses = 2;

std::vector<Response> responses(const Log& log, int joint) {
  const std::vector<double>& u = log.column(joint_column("u", joint, "_plan"));
  const std::vector<double>& v = log.column(joint_column("dtheta", joint));
  const std::vector<double>& time = log.column("time");
  std::vector<Response> all;
  for (std::size_t from = 0; from < u.size();) {
    std::size_t to = from + 1;
    while (to < u.size() && u[to] == u[from]) ++to;
    if (u[from] != 0 && to - from >= kFewestRows) {
      Response r{u[from], {}, {}};
      for (std::size_t row = from; row < to; ++row) {
        r.time.push_back(time[row] - time[from]);
        r.v.push_back(v[row]);
      }
      all.push_back(std::move(r));
    }
    from = to;
  }
  if (all.size() < kFewestResponses) {
    throw InputError(log.source, joint_column("u", joint, "_plan"),
                     fmt::format("{} constant torques; at least {} are needed", all.size(), kFewestResponses));
  }
  return all;
}

double model(double u, double inertia, double viscous, double t) {
  return t > 0 ? -u / viscous * std::expm1(-t * viscous / inertia) : 0;
}

// Parameters: J, B, t0 of each response.
class Residual {
 public:
  explicit Residual(const std::vector<Response>& all) : all_(all) {}

  Eigen::Index size() const {
    Eigen::Index n = 0;
    for (const Response& r : all_) n += static_cast<Eigen::Index>(r.v.size());
    return n;
  }

  void operator()(const Eigen::VectorXd& p, Eigen::VectorXd& out) const {
    Eigen::Index i = 0;
    for (std::size_t k = 0; k < all_.size(); ++k) {
      const double t0 = p[static_cast<Eigen::Index>(2 + k)];
      for (std::size_t row = 0; row < all_[k].v.size(); ++row) {
        out[i++] = model(all_[k].u, p[0], p[1], all_[k].time[row] - t0) - all_[k].v[row];
      }
    }
  }

 private:
  const std::vector<Response>& all_;
};

// Final speed u/B, and the time constant J/B at which 1 - 1/e of it is reached.
Eigen::VectorXd start(const std::vector<Response>& all) {
  Eigen::VectorXd p = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(2 + all.size()));
  const Response& r = all.back();
  const double last = robust_mean(std::span(r.v).last(r.v.size() / 10 + 1)).mean;
  std::size_t row = 0;
  while (row + 1 < r.v.size() && std::abs(r.v[row]) < (1 - std::exp(-1)) * std::abs(last)) ++row;
  p[1] = r.u / last;
  p[0] = p[1] * r.time[row];
  return p;
}

Fit fit_all(const std::vector<Response>& all, const Eigen::VectorXd& from) {
  const Residual residual(all);
  return curve_fit(residual, residual.size(), from);
}

std::vector<Response> without_outliers(const std::vector<Response>& all, const Fit& fit, double floor) {
  const std::vector<bool> inside =
      inliers({fit.residuals.data(), static_cast<std::size_t>(fit.residuals.size())}, floor);
  std::vector<Response> kept;
  std::size_t i = 0;
  for (const Response& r : all) {
    kept.push_back({r.u, {}, {}});
    for (std::size_t row = 0; row < r.v.size(); ++row, ++i) {
      if (!inside[i]) continue;
      kept.back().time.push_back(r.time[row]);
      kept.back().v.push_back(r.v[row]);
    }
  }
  return kept;
}

}  // namespace

Estimate identify_motor_inertia(const Log& log, int joint, const Parameters& robot) {
  const auto j = static_cast<std::size_t>(joint);
  require_experiment(log, "motor_inertia", joint);
  Estimate e;
  e.names = {"inertia", "viscous"};
  e.units = {"kg m^2", "N m s/rad"};
  warn_of_gaps(log, e.warnings);
  std::vector<Response> all = responses(log, joint);
  const Eigen::VectorXd from = start(all);
  require_plausible(log, fmt::format("the viscous friction of motor {} [N m s/rad]", joint + 1), from[1],
                    robot.friction.viscous[j]);
  Fit fit = fit_all(all, from);
  double fastest = 0;
  for (const Response& r : all) fastest = std::max(fastest, std::abs(r.u) / fit.value[1]);
  all = without_outliers(all, fit, 1e-3 * fastest);
  const auto rejected = static_cast<std::size_t>(fit.residuals.size() - Residual(all).size());
  warn_of_outliers(rejected, "velocities", e.warnings);
  if (rejected > 0) fit = fit_all(all, fit.value);

  e.value = fit.value.head(2);
  e.covariance = fit.covariance.topLeftCorner(2, 2);
  e.points = static_cast<std::size_t>(fit.residuals.size());
  e.residual_rms = fit.residual_rms;
  e.residual_unit = "rad/s";
  e.plot = {fmt::format("Velocity responses of motor {}", joint + 1), "time [s]", "dtheta [rad/s]", {}, {}, {}};
  double square = 0;
  Eigen::Index i = 0;
  for (const Response& r : all) {
    for (std::size_t row = 0; row < r.v.size(); ++row, ++i) {
      square += r.v[row] * r.v[row];
      e.plot.x.push_back(r.time[row]);
      e.plot.y.push_back(r.v[row]);
      e.plot.fitted.push_back(r.v[row] + fit.residuals[i]);
    }
  }
  e.r_squared = 1 - fit.residuals.squaredNorm() / square;
  require_plausible(log, fmt::format("the inertia of motor {} [kg m^2]", joint + 1), e.value[0],
                    robot.motor.inertia[j]);
  return e;
}

}  // namespace fjr
