// What is reported of an infeasible request: what is in the way, when, and what would have to change.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace fjr {

struct ConstraintInfo;
struct QuantityInfo;
struct Relaxable;
enum class RelaxableKind;  // planner/problem/relaxable.h

// One thing of the request that, changed alone, makes it feasible.
struct Relaxation {
  RelaxableKind kind;
  std::string name;  // as in problem/relaxable.h; or duration; or via[0].time
  int joint = 0;     // 1 or 2; 0: neither
  std::string unit;
  double from = 0, to = 0;  // the requested value; the least change found to be enough, as reported
  bool rough = false;  // not verified by planning, or found with friction smoothed only: `to` is about what it takes
  bool within_robot = true;                    // false: beyond what robot.yaml allows a request to ask for
  std::optional<double> time;                  // [s] when it is in the way most
  const QuantityInfo* quantity = nullptr;      // of a limit
  const ConstraintInfo* constraint = nullptr;  // of the task
};

// to: in the unit of `what`; for a velocity, as a fraction of the requested one.
Relaxation relaxation_of(const Relaxable& what, double to);

// Makes the relaxation of a requested time [s]: of the duration or of a via point.
Relaxation relaxation_of_time(RelaxableKind kind, const std::string& name, double from, double to);

// Returns its name in a sentence: "torque of joint 1", "obstacles[0]".
std::string name_of(const std::string& name, int joint);

// Returns `to` in the four digits in which it is reported, rounded so that the change from `from` never becomes
// smaller.
double told(double from, double to);

// "torque of joint 1 alone would have to be 5.1 N m (now 5)"
std::string sentence_of(const Relaxation& relaxation);

struct Infeasibility {
  std::string sentence;
  std::string limit;  // what is in the way, named as in Relaxation; empty where nothing single is
  int joint = 0;
  const QuantityInfo* quantity = nullptr;   // of the limit that is in the way
  std::optional<double> time;               // [s] when
  std::vector<Relaxation> relaxations;      // the smallest change, relative to what was asked for, first
  std::optional<double> shortest_duration;  // [s] within the limits, where there is one
};

}  // namespace fjr
