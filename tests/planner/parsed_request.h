// Requests as the tests write them: texts for the arm of the paper, to be read and resolved, or refused.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "common/input_error.h"
#include "planner/problem/problem.h"
#include "planner/request/request.h"

namespace fjr {

inline const std::filesystem::path kRobot = std::filesystem::path(FJR_SOURCE_DIR) / "config/robot.yaml";

// A valid request; tests append to it or replace its lines.
inline const std::string kStart = "start: {q: [0, 0]}\n", kGoal = "goal: {q: [1.2, -0.8]}\n", kMove = kStart + kGoal;

inline Request read(const std::string& yaml) { return read_request(yaml, "request.yaml"); }

inline Problem parse(const std::string& yaml) { return parse_request(yaml, "request.yaml", ".", kRobot); }

// With what words a request is refused.
inline std::string error_of(const std::string& yaml) {
  try {
    parse(yaml);
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

struct Broken {
  std::string yaml, message;
};

inline void expect_refused(const std::vector<Broken>& cases) {
  for (const Broken& c : cases) EXPECT_EQ(error_of(c.yaml), "request.yaml: " + c.message) << c.yaml;
}

inline void expect_weights(const Weights& w, double time, double effort, double torque_rate, double link_acceleration) {
  EXPECT_EQ(w.time, time);
  EXPECT_EQ(w.effort, effort);
  EXPECT_EQ(w.torque_rate, torque_rate);
  EXPECT_EQ(w.link_acceleration, link_acceleration);
}

}  // namespace fjr
