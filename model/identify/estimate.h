// The result of an identification procedure, with its uncertainty.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <any>
#include <cmath>
#include <string>
#include <vector>

namespace fjr {

struct Estimate {
  std::string procedure;  // "stiffness", ...
  int joint = 0;          // 0 or 1
  std::string log, hash;  // file and its SHA-256

  std::vector<std::string> names, units;
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;  // rows of assumed values, which were not identified, are zero; see `warnings`
  std::vector<std::string> assumed;

  std::size_t points = 0;   // used by the final fit
  double residual_rms = 0;  // in the unit of the fitted quantity, residual_unit
  std::string residual_unit;
  double r_squared = 0;  // fraction of the variance explained
  std::vector<std::string> warnings;
  // The measured data with what was fitted to them, in a type of the procedure's own, from which charts_of() (charts.h)
  // draws. Empty if several logs were combined.
  std::any fitted;

  Eigen::Index index(const std::string& name) const {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] == name) return static_cast<Eigen::Index>(i);
    }
    return -1;
  }
  bool is_assumed(const std::string& name) const {
    return std::find(assumed.begin(), assumed.end(), name) != assumed.end();
  }
  double at(const std::string& name) const { return value[index(name)]; }
  double standard_error(const std::string& name) const { return std::sqrt(covariance(index(name), index(name))); }
};

}  // namespace fjr
