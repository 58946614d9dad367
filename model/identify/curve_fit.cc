// Only this file uses Ceres.
#include <ceres/ceres.h>

#include <cmath>
#include <memory>
#include <vector>

#include "model/identify/fit.h"

namespace fjr {
namespace {

struct Functor {
  const Residuals& residuals;
  Eigen::Index parameters, size;

  bool operator()(double const* const* x, double* out) const {
    Eigen::VectorXd r(size);
    residuals(Eigen::Map<const Eigen::VectorXd>(x[0], parameters), r);
    if (!r.allFinite()) return false;
    Eigen::Map<Eigen::VectorXd>(out, size) = r;
    return true;
  }
};

class SlopedCost : public ceres::CostFunction {
 public:
  SlopedCost(const SlopedResiduals& residuals, Eigen::Index parameters, Eigen::Index size) : residuals_(residuals) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(parameters));
    set_num_residuals(static_cast<int>(size));
  }

  bool Evaluate(double const* const* x, double* out, double** slopes) const override {
    const Eigen::Index parameters = parameter_block_sizes().front(), size = num_residuals();
    const bool wanted = slopes != nullptr && slopes[0] != nullptr;
    Eigen::VectorXd r(size);
    Eigen::MatrixXd jacobian(wanted ? size : 0, parameters);
    if (!residuals_(Eigen::Map<const Eigen::VectorXd>(x[0], parameters), r, wanted ? &jacobian : nullptr)) return false;
    if (!r.allFinite() || !jacobian.allFinite()) return false;
    Eigen::Map<Eigen::VectorXd>(out, size) = r;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    if (wanted) Eigen::Map<RowMajor>(slopes[0], size, parameters) = jacobian;
    return true;
  }

 private:
  const SlopedResiduals& residuals_;
};

ceres::Solver::Options quiet_options() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  return options;
}

Eigen::MatrixXd dense(const ceres::CRSMatrix& sparse) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row) {
    const auto r = static_cast<std::size_t>(row);
    for (int k = sparse.rows[r]; k < sparse.rows[r + 1]; ++k) {
      matrix(row, sparse.cols[static_cast<std::size_t>(k)]) = sparse.values[static_cast<std::size_t>(k)];
    }
  }
  return matrix;
}

// Returns a fit that compares as worse than any other.
Fit failed(Eigen::Index size, const Eigen::VectorXd& value) {
  Fit fit;
  fit.value = value;
  fit.covariance = Eigen::MatrixXd::Zero(value.size(), value.size());
  fit.residuals = Eigen::VectorXd::Constant(size, HUGE_VAL);
  fit.residual_rms = HUGE_VAL;
  fit.determined = false;
  return fit;
}

}  // namespace

Fit curve_fit(const Residuals& residuals, Eigen::Index size, const Eigen::VectorXd& start) {
  const Functor functor{residuals, start.size(), size};
  Fit fit;
  fit.value = start;
  fit.residuals.resize(size);
  if (const double* x = start.data(); !functor(&x, fit.residuals.data())) return failed(size, start);
  auto cost = std::make_unique<ceres::DynamicNumericDiffCostFunction<Functor, ceres::CENTRAL>>(new Functor(functor));
  cost->AddParameterBlock(static_cast<int>(start.size()));
  cost->SetNumResiduals(static_cast<int>(size));
  ceres::Problem problem;
  problem.AddResidualBlock(cost.release(), nullptr, fit.value.data());  // the problem owns it from here

  ceres::Solver::Options options = quiet_options();
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 1e-20;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  std::vector<double> r;
  ceres::CRSMatrix jacobian;
  if (!problem.Evaluate({}, nullptr, &r, nullptr, &jacobian))
    throw std::runtime_error("the fit left the model's range");
  fit.residuals = Eigen::Map<const Eigen::VectorXd>(r.data(), size);
  fit.jacobian = dense(jacobian);
  add_uncertainty(fit);
  return fit;
}

Fit curve_fit(const SlopedResiduals& residuals, Eigen::Index size, const Eigen::VectorXd& start) {
  Fit fit;
  fit.value = start;
  ceres::Problem problem;
  auto cost = std::make_unique<SlopedCost>(residuals, start.size(), size);
  problem.AddResidualBlock(cost.release(), nullptr, fit.value.data());  // it owns it
  ceres::Solver::Options options = quiet_options();
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-6;
  // The parameters of an arm are strongly correlated, and Levenberg-Marquardt damping would make the steps along the
  // correlated directions small. Therefore dogleg is used.
  options.trust_region_strategy_type = ceres::DOGLEG;
  options.dogleg_type = ceres::SUBSPACE_DOGLEG;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  fit.residuals.resize(size);
  fit.jacobian.resize(size, start.size());
  if (!summary.IsSolutionUsable() || !residuals(fit.value, fit.residuals, &fit.jacobian))
    return failed(size, fit.value);
  add_uncertainty(fit);
  fit.determined = fit.determined && summary.termination_type == ceres::CONVERGENCE;
  return fit;
}

}  // namespace fjr
