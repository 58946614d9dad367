#include "model/identify/arm.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "common/dual.h"
#include "model/dynamics.h"
#include "model/identify/procedures.h"
#include "model/identify/repeated.h"
#include "model/uncertainty.h"

namespace fjr {
namespace {

// Where an input of joint 1 stands; that of joint 2 is behind it.
constexpr std::size_t place_of(ArmInput input) { return static_cast<std::size_t>(input) * kJoints; }

// Inputs: K1, K2, S1 (6), S2 (7), k1 = K1/I1, k2 = K2/I2, d1 = D1/I1, d2 = D2/I2.
constexpr std::size_t kStiffness = place_of(ArmInput::kStiffness), kSlope = place_of(ArmInput::kGravitySlope),
                      kRate = place_of(ArmInput::kStiffnessOverInertia),
                      kDecay = place_of(ArmInput::kDampingOverInertia), kInputs = 8;
constexpr std::size_t kOutputs = 10, kDamping = 8;
constexpr std::array<const char*, kOutputs> kOutputNames = {"spring.stiffness[0]",
                                                            "spring.stiffness[1]",
                                                            "link.gravity_torque[0]",
                                                            "link.gravity_torque[1]",
                                                            "link.com_fraction[0]",
                                                            "link.com_fraction[1]",
                                                            "link.inertia[0]",
                                                            "link.inertia[1]",
                                                            "damping[0]",
                                                            "damping[1]"};
// For each output the input whose experiment is required. Without it the output keeps its known value; other inputs may
// come from the robot known so far.
constexpr std::array<std::size_t, kOutputs> kDecidedBy = {0, 1, 2, 3, 2, 3, 4, 5, 6, 7};

template <class T>
std::array<T, kOutputs> arm_parameters(const Parameters& p, const std::array<T, kInputs>& in) {
  const double l1 = p.link.length[0], l2 = p.link.length[1], m1 = p.link.mass[0], m2 = p.link.mass[1];
  const T i1 = in[kStiffness] / in[kRate], i2 = in[kStiffness + 1] / in[kRate + 1];  // (11)
  const T g1 = in[kSlope] - in[kSlope + 1], g2 = in[kSlope + 1];                     // (6), (7) -> (8)
  const T alpha1 = (g1 / (kPaperGravity * l1) - m2) / m1;
  const T alpha2 = g2 / (m2 * kPaperGravity * l2);
  const T r2 = alpha2 * l2;
  const T inertia1 = i1 - m2 * l1 * l1 - i2 - 2.0 * m2 * l1 * r2, inertia2 = i2 - m2 * r2 * r2;  // (18)
  return {in[kStiffness],  in[kStiffness + 1], g1, g2, alpha1, alpha2, inertia1, inertia2,
          in[kDecay] * i1, in[kDecay + 1] * i2};
}

struct Inputs {
  std::array<double, kInputs> value;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(kInputs, kInputs);
  std::array<const Repeated*, kInputs> from{};
};

Inputs inputs_of(const Parameters& p) {
  const MassMatrix<double> m = mass_matrix(p, 0.0);
  const Joints<double>& k = p.spring.stiffness;
  const Joints<double>& g = p.link.gravity_torque;
  return {{k[0], k[1], g[0] + g[1], g[1], k[0] / m.m11, k[1] / m.m22, p.link.damping[0] / m.m11,
           p.link.damping[1] / m.m22}};
}

void take(Inputs& in, const Repeated& repeated, const std::vector<ArmInput>& inputs) {
  if (inputs.empty()) return;
  const Estimate& e = repeated.estimate;
  std::vector<Eigen::Index> rows;
  for (const ArmInput input : inputs) {
    const std::size_t at = place_of(input) + static_cast<std::size_t>(e.joint);
    in.value[at] = e.value[static_cast<Eigen::Index>(rows.size())];
    in.from[at] = &repeated;
    rows.push_back(static_cast<Eigen::Index>(at));
  }
  in.covariance(rows, rows) = e.covariance;
}

struct Outputs {
  std::array<double, kOutputs> value;
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(kOutputs, kInputs);
};

Outputs outputs_of(const Parameters& p, const Inputs& in) {
  using Active = Dual<static_cast<int>(kInputs)>;
  std::array<Active, kInputs> active;
  for (std::size_t i = 0; i < kInputs; ++i) active[i] = Active::input(in.value[i], static_cast<int>(i));
  const std::array<Active, kOutputs> out = arm_parameters(p, active);
  Outputs outputs;
  for (std::size_t i = 0; i < kOutputs; ++i) {
    outputs.value[i] = out[i].v;
    for (std::size_t k = 0; k < kInputs; ++k) {
      outputs.jacobian(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = out[i].g[k];
    }
  }
  return outputs;
}

// Appends a block that is not correlated with the existing ones.
void append(Eigen::MatrixXd& covariance, const Eigen::MatrixXd& block) {
  const Eigen::Index n = covariance.rows(), m = block.rows();
  covariance.conservativeResizeLike(Eigen::MatrixXd::Zero(n + m, n + m));
  covariance.bottomRightCorner(m, m) = block;
}

void tell_arm(const Inputs& in, const Outputs& out, Identified& result) {
  const Eigen::MatrixXd covariance = out.jacobian * in.covariance * out.jacobian.transpose();
  std::vector<Eigen::Index> told;
  for (std::size_t i = 0; i < kOutputs; ++i) {
    if (in.from[kDecidedBy[i]] == nullptr) continue;
    const auto row = static_cast<Eigen::Index>(i);
    if (i >= kDamping) {
      result.damping[i - kDamping] = out.value[i];
      result.damping_error[i - kDamping] = std::sqrt(covariance(row, row));
      result.has_damping[i - kDamping] = true;
      continue;
    }
    *parameter_named(result.robot, kOutputNames[i]) = out.value[i];
    result.names.emplace_back(kOutputNames[i]);
    told.push_back(row);
    for (std::size_t k = 0; k < kInputs; ++k) {
      const bool matters = out.jacobian(row, static_cast<Eigen::Index>(k)) != 0;
      if (!matters || in.from[k] == nullptr) continue;
      std::vector<const Estimate*>& from = result.from[kOutputNames[i]];
      from.insert(from.end(), in.from[k]->logs.begin(), in.from[k]->logs.end());
    }
  }
  append(result.covariance, covariance(told, told));
}

// parameters: what the estimate tells directly, "motor.inertia".
void tell_parameters(const Repeated& repeated, const std::vector<std::string>& parameters, Identified& result) {
  const Estimate& e = repeated.estimate;
  std::vector<Eigen::Index> told;
  for (const std::string& parameter : parameters) {
    const std::string estimated = parameter.substr(parameter.find('.') + 1);
    const std::string name = fmt::format("{}[{}]", parameter, e.joint);
    *parameter_named(result.robot, name) = e.at(estimated);
    if (e.is_assumed(estimated)) continue;  // a value to go with the others, but not found out
    result.names.push_back(name);
    result.from[name] = repeated.logs;
    told.push_back(e.index(estimated));
  }
  append(result.covariance, e.covariance(told, told));
}

}  // namespace

Identified combine(const Parameters& base, const std::vector<Estimate>& estimates) {
  Inputs in = inputs_of(base);
  const std::vector<Repeated> all = combine_repeated(estimates);
  for (const Repeated& one : all) {
    if (const Procedure* by = find_procedure(one.estimate.procedure)) take(in, one, by->arm_inputs);
  }
  Identified result;
  result.robot = base;
  tell_arm(in, outputs_of(base, in), result);
  for (const Repeated& one : all) {
    if (const Procedure* by = find_procedure(one.estimate.procedure)) tell_parameters(one, by->parameters, result);
  }
  return result;
}

}  // namespace fjr
