#include "planner/program/doubts.h"

#include <set>
#include <string>

#include "common/say.h"
#include "model/plausibility.h"

namespace fjr {

void tell_doubts(const Parameters& robot) {
  static std::set<std::string> told;
  for (const Finding& doubt : doubts_about(robot)) {
    if (told.insert(doubt.text()).second) say("fjr: warning: robot: {}\n", doubt.text());
  }
}

}  // namespace fjr
