#include "planner/collocation/collocate.h"

#include <algorithm>
#include <cmath>

#include "planner/collocation/margins.h"
#include "planner/collocation/transcribe.h"
#include "planner/collocation/transfer.h"

namespace fjr {
namespace {

template <int N>
NodeBounds<N> node(std::size_t index) {
  return {index, filled<N>(-kNoLimit), filled<N>(kNoLimit)};
}

template <int N>
void fix(NodeBounds<N>& bounds, std::size_t first, const Pair<double>& values) {
  for (std::size_t j = 0; j < kJoints; ++j) bounds.lower[first + j] = bounds.upper[first + j] = values[j];
}

// Start, via points and goal as bounds at nodes of the mesh.
template <int N>
std::vector<NodeBounds<N>> node_bounds(const Problem& problem, const Mesh& mesh) {
  std::vector<NodeBounds<N>> bounds;
  auto start = node<N>(0);
  for (std::size_t i = 0; i < kStates; ++i) start.lower[i] = start.upper[i] = problem.start.data()[i];
  bounds.push_back(start);
  if (!problem.via.empty()) {  // only with a fixed duration, so node times are known
    const std::vector<double> times = mesh.node_times({problem.duration.min});
    for (const Via& via : problem.via) {
      const auto nearest = std::min_element(times.begin(), times.end(), [&](double a, double b) {
        return std::abs(a - via.time) < std::abs(b - via.time);
      });
      auto at = node<N>(static_cast<std::size_t>(nearest - times.begin()));
      fix(at, 0, via.q);
      if (via.dq) fix(at, 2, *via.dq);
      bounds.push_back(at);
    }
  }
  auto goal = node<N>(mesh.size());
  fix(goal, 0, problem.goal.q);
  fix(goal, 2, problem.goal.dq);
  if (problem.goal.theta) fix(goal, 4, *problem.goal.theta);
  if (problem.goal.dtheta) fix(goal, 6, *problem.goal.dtheta);
  bounds.push_back(goal);
  return bounds;
}

template <bool kRate>
std::vector<typename ArmOcp<kRate>::Bounds> interval_bounds(const Problem& problem, const CollocationSetup& setup) {
  std::vector<typename ArmOcp<kRate>::Bounds> bounds;
  const std::vector<Limits> kept = kept_limits(problem, setup.mesh, setup.margins);
  for (std::size_t k = 0; k < setup.mesh.size(); ++k) {
    bounds.push_back(path_bounds<kRate>(kept[k]));
    for (std::size_t j = 0; j < kJoints && !setup.creep.empty(); ++j) {
      const double creep = setup.creep[k][j];
      if (creep > 0) bounds.back().x_lower[6 + j] = creep;
      if (creep < 0) bounds.back().x_upper[6 + j] = creep;
    }
  }
  return bounds;
}

}  // namespace

template <bool kRate>
Transcription<ArmOcp<kRate>> transcribe(const Problem& problem, const CollocationSetup& setup) {
  auto ocp = make_arm_ocp<kRate>(problem, setup.smoothing.regularisation);
  ocp.bounds = interval_bounds<kRate>(problem, setup);
  for (FrictionLaw& law : ocp.friction) law = law.smoothed(setup.smoothing.friction_width);
  ocp.at_nodes = node_bounds<ArmOcp<kRate>::kStates>(problem, setup.mesh);
  ocp.durations.assign(static_cast<std::size_t>(setup.mesh.segments()), {problem.duration.min, problem.duration.max});
  ocp.total_duration = {problem.duration.min, problem.duration.max};
  return {std::move(ocp), setup.scheme, setup.mesh};
}
template Transcription<ArmOcp<false>> transcribe(const Problem&, const CollocationSetup&);
template Transcription<ArmOcp<true>> transcribe(const Problem&, const CollocationSetup&);

namespace {

// Positions as the integral of the velocity polynomial, so that both columns of a published row say the same between
// the collocation points too. It still meets the next node: the scheme's quadrature is exact for polynomials of the
// velocity's degree, its number of stages, except for the trapezoidal rule.
Eigen::MatrixXd with_consistent_positions(const Eigen::MatrixXd& state, double duration) {
  const Eigen::Index degree = state.cols() - 1;
  if (degree < 3) return state;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(state.rows(), state.cols() + 1);
  result.leftCols(state.cols()) = state;
  for (const Eigen::Index position : {0, 1, 4, 5}) {
    for (Eigen::Index d = 0; d <= degree; ++d) {
      result(position, d + 1) = duration * state(position + 2, d) / static_cast<double>(d + 1);
    }
  }
  return result;
}

template <bool kRate>
Motion motion_of(const Transcription<ArmOcp<kRate>>& transcription, const Eigen::VectorXd& z) {
  Motion motion;
  const std::vector<double> times = transcription.mesh().node_times(transcription.durations(z));
  for (int k = 0; k < transcription.intervals(); ++k) {
    const double start = times[static_cast<std::size_t>(k)], end = times[static_cast<std::size_t>(k) + 1];
    const Eigen::MatrixXd state = with_consistent_positions(transcription.state_polynomial(z, k), end - start);
    if constexpr (kRate) {
      motion.intervals.push_back({start, end - start, state.topRows<kStates>(), state.bottomRows<kControls>()});
    } else {
      motion.intervals.push_back({start, end - start, state, transcription.control_polynomial(z, k)});
    }
  }
  return motion;
}

template <bool kRate>
Iterate evaluate_guess(const Transcription<ArmOcp<kRate>>& transcription, const Guess& guess) {
  Eigen::VectorXd z = Eigen::VectorXd::Zero(transcription.variables());
  const auto put = [&](int at, double s) {
    const State<double> x = guess.state(s);
    z.segment<kStates>(at) = Eigen::Map<const Eigen::Matrix<double, kStates, 1>>(x.data());
    if constexpr (kRate) z.segment<kControls>(at + kStates) = Eigen::Map<const Eigen::Vector2d>(guess.torque(s).data());
  };
  const std::vector<double> shares = transcription.mesh().node_times(
      std::vector<double>(static_cast<std::size_t>(transcription.mesh().segments()), 1.0));
  put(0, 0);
  for (int k = 0; k < transcription.intervals(); ++k) {
    const double from = shares[static_cast<std::size_t>(k)], to = shares[static_cast<std::size_t>(k) + 1];
    if constexpr (!kRate) {
      for (int end = 0; end < 2; ++end) {  // just inside the interval: a guess may jump at its ends
        const Pair<double> u = guess.torque((from + (end == 0 ? 1e-6 : 1 - 1e-6) * (to - from)) / shares.back());
        z.segment<kControls>(transcription.u_at(k, end)) = Eigen::Map<const Eigen::Vector2d>(u.data());
      }
    }
    for (int j = 0; j < transcription.scheme().stages(); ++j) {
      const double c = transcription.scheme().points(j), s = (from + c * (to - from)) / shares.back();
      if (transcription.x_at(k, j) != transcription.node_at(k)) put(transcription.x_at(k, j), s);
    }
  }
  for (int s = 0; s < transcription.mesh().segments(); ++s) {
    z(transcription.duration_at(s)) = guess.duration / transcription.mesh().segments();
  }
  return {z, {}, {}, {}};
}

template <bool kRate>
Collocated run(const CollocationSetup& setup, const Transcription<ArmOcp<kRate>>& transcription, const Iterate& start,
               const SolveOptions& options) {
  Collocated result{setup, solve(transcription, start, options), {}, {}};
  if (result.report.iterate.x.size() == transcription.variables()) {
    result.durations = transcription.durations(result.report.iterate.x);
    result.motion = motion_of(transcription, result.report.iterate.x);
  }
  return result;
}

template <bool kRate>
Collocated run(const Problem& problem, const CollocationSetup& setup, const Guess& guess, const SolveOptions& options) {
  const auto transcription = transcribe<kRate>(problem, setup);
  return run(setup, transcription, evaluate_guess(transcription, guess), options);
}

bool fits(const Nlp& nlp, const Iterate& iterate) {
  return iterate.x.size() == nlp.variables() && iterate.lambda.size() == nlp.constraints() &&
         iterate.z_lower.size() == nlp.variables() && iterate.z_upper.size() == nlp.variables();
}

template <bool kRate>
Collocated run(const Problem& problem, const CollocationSetup& setup, const Collocated& start,
               const SolveOptions& options) {
  const auto transcription = transcribe<kRate>(problem, setup);
  if (setup.mesh == start.setup.mesh) {
    if (!fits(transcription, start.report.iterate)) return {setup, {}, {}, {}};
    return run(setup, transcription, start.report.iterate, options);
  }
  const auto before = transcribe<kRate>(problem, start.setup);
  if (!fits(before, start.report.iterate)) return {setup, {}, {}, {}};
  const Iterate transferred = Transfer<ArmOcp<kRate>>(before, start.report.iterate, transcription).run();
  return run(setup, transcription, transferred, options);
}

}  // namespace

bool needs_rate(const Problem& problem) {
  return problem.weights.torque_rate > 0 || problem.limits.torque_rate[0] < kNoLimit ||
         problem.limits.torque_rate[1] < kNoLimit;
}

Mesh uniform_mesh(const Problem& problem, int intervals) {
  std::vector<double> cuts{0};
  for (const Via& via : problem.via) cuts.push_back(via.time / problem.duration.min);
  cuts.push_back(1);
  Mesh mesh;
  for (std::size_t leg = 0; leg + 1 < cuts.size(); ++leg) {
    const double share = cuts[leg + 1] - cuts[leg];
    const int pieces = std::max(2, static_cast<int>(std::lround(share * intervals)));
    for (int i = 0; i < pieces; ++i) mesh.intervals.push_back({share / pieces, 0});
  }
  return mesh;
}

Collocated collocate(const Problem& problem, const CollocationSetup& setup, const Guess& guess,
                     const SolveOptions& options) {
  return needs_rate(problem) ? run<true>(problem, setup, guess, options) : run<false>(problem, setup, guess, options);
}

Collocated collocate(const Problem& problem, const CollocationSetup& setup, const Collocated& start,
                     const SolveOptions& options) {
  return needs_rate(problem) ? run<true>(problem, setup, start, options) : run<false>(problem, setup, start, options);
}

}  // namespace fjr
