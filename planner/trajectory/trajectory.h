// A trajectory as it is published: samples of time, state and motor torque.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "model/dynamics.h"

namespace fjr {

inline constexpr std::size_t kMaxRows = 32768;
inline constexpr double kLongestSpacing = 5e-3;  // [s] between two samples
inline constexpr double kJumpSpacing = 1e-6;     // [s] between the two samples of a torque jump
// The "status" of rows that were corrected by executed motions, where those of a plan have its status.
inline constexpr const char* kLearntStatus = "learnt";

struct Sample {
  double time = 0;          // [s]
  State<double> state{};    // [rad], [rad/s]
  Joints<double> torque{};  // tau_m [N m]
};

// Between samples the torque is linear, positions are cubic Hermite polynomials, and velocities are their derivatives.
struct Trajectory {
  std::vector<Sample> samples;                  // strictly increasing time, at least two
  std::map<std::string, std::string> metadata;  // the "# key: value" lines

  double start_time() const { return samples.front().time; }
  double end_time() const { return samples.back().time; }
};

// Evaluates a trajectory at increasing or arbitrary times; remembers the last interval, so sweeping is O(1) a step.
// Holds a reference: the trajectory must outlive it. Times outside are clamped to the ends.
class Interpolator {
 public:
  explicit Interpolator(const Trajectory& trajectory) : trajectory_(&trajectory) {}
  Sample at(double time);
  Joints<double> torque_at(double time);
  // Returns the mean of the piecewise linear torque [N m] over [from, to]; a drive that holds one value per tick gets
  // it.
  Joints<double> mean_torque(double from, double to);

 private:
  std::size_t interval(double time);
  const Trajectory* trajectory_;
  std::size_t last_ = 0;
};

// The CSV of README, Files. Reading is strict: InputError names file, line and column for anything that is not a finite
// number, a missing or repeated column, times that do not increase, fewer than 2 or more than kMaxRows rows. Additional
// columns are allowed and ignored. Writing is atomic (temporary file, then rename) and byte-reproducible.
Trajectory read_csv(const std::filesystem::path& file);
Trajectory parse_csv(std::istream& in, const std::string& source);
// Returns a sentence if the file does not contain as many rows as its header says. It was cut short then, or edited.
std::optional<std::string> rows_missing(const Trajectory& trajectory);
void write_csv(const Trajectory& trajectory, const std::filesystem::path& file);
void format_csv(const Trajectory& trajectory, std::ostream& out);

}  // namespace fjr
