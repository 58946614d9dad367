#include "planner/search/explain/relaxation.h"

#include <fmt/format.h>

#include <cmath>

#include "common/rounded.h"
#include "planner/problem/relaxable.h"

namespace fjr {

Relaxation relaxation_of(const Relaxable& what, double to) {
  Relaxation r;
  r.kind = what.kind;
  r.name = what.name;
  r.joint = what.joint;
  r.unit = what.unit;
  r.from = what.from;
  r.to = told(what.from, to);
  r.within_robot = std::abs(r.to - what.from) <= what.allowed;
  r.quantity = what.quantity;
  r.constraint = what.constraint;
  return r;
}

Relaxation relaxation_of_time(RelaxableKind kind, const std::string& name, double from, double to) {
  Relaxation r;
  r.kind = kind;
  r.name = name;
  r.unit = "s";
  r.from = from;
  r.to = kind == RelaxableKind::kDuration ? to : told(from, to);  // a duration is rounded up already
  r.time = from;
  return r;
}

std::string name_of(const std::string& name, int joint) {
  return joint == 0 ? name : fmt::format("{} of joint {}", name, joint);
}

double told(double from, double to) {
  constexpr int kDigits = 4;
  double rounded = rounded_to(to, kDigits);
  const double step = std::pow(10, std::floor(std::log10(std::abs(to))) - 3);
  if (to > from && rounded < to) rounded += step;
  if (to < from && rounded > to) rounded -= step;
  return rounded_to(rounded, kDigits);
}

std::string sentence_of(const Relaxation& r) {
  const std::string beyond = r.within_robot ? "" : ", more than the robot's", about = r.rough ? "about " : "",
                    to = fmt::format("{:.4g}", r.to);
  if (r.kind == RelaxableKind::kBothJoints) {
    return fmt::format("{} of both joints would have to be {}{} times as large{}", r.name, about, to, beyond);
  }
  if (r.kind == RelaxableKind::kAllLimits) {
    return fmt::format("no single limit alone would do, but all together {} times as large{}", to, beyond);
  }
  if (r.constraint && r.constraint->relaxed) {
    return fmt::format("{} alone would have to be {}", r.name,
                       fmt::format(fmt::runtime(r.constraint->relaxed), about + to));
  }
  const std::string name = name_of(r.name, r.joint);
  if (r.kind == RelaxableKind::kVelocity) {
    return fmt::format("{} alone would have to be {}{} times the requested one{}", name, about, to, beyond);
  }
  return fmt::format("{} alone would have to be {}{} {} (now {:.4g}{})", name, about, to, r.unit, r.from, beyond);
}

}  // namespace fjr
