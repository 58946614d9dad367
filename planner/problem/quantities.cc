#include "planner/problem/quantities.h"

#include <algorithm>

namespace fjr {

std::string_view unit_of_limit(std::string_view name) {
  const auto found = std::find_if(Quantities::infos.begin(), Quantities::infos.end(),
                                  [name](const QuantityInfo& info) { return info.name == name; });
  return found == Quantities::infos.end() ? "" : found->get().unit;
}

Limits Limits::of(const Parameters& p) {
  Limits limits;
  for (const QuantityInfo& info : Quantities::infos) {
    if (info.of_robot) limits.*info.per_joint = p.limits.*info.of_robot;
  }
  limits.link_middle = p.limits.link_middle;
  return limits;
}

}  // namespace fjr
