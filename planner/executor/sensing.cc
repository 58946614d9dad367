#include "planner/executor/sensing.h"

#include <cmath>

namespace fjr {
namespace {

constexpr Joints<const char*> kLinks{"q1", "q2"}, kMotors{"theta1", "theta2"};

Joints<VelocityFilter> filters(const Parameters& robot) {
  return {VelocityFilter(robot.feedback.velocity_filter[0], kTick),
          VelocityFilter(robot.feedback.velocity_filter[1], kTick)};
}

}  // namespace

Sensing::Sensing(const Parameters& robot) : link_{.filter = filters(robot)}, motor_{.filter = filters(robot)} {}

void Sensing::start(const Joints<double>& q, const Joints<double>& theta) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    link_.position[j] = q[j];
    motor_.position[j] = theta[j];
    link_.filter[j].reset(q[j], 0);
    motor_.filter[j].reset(theta[j], 0);
  }
}

void Sensing::Encoders::update(const Joints<std::optional<double>>& samples, const Joints<double>& planned, int ticks) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    const bool there = samples[j] && std::isfinite(*samples[j]);  // a filter would keep a NaN for ever
    if (there) {
      missing[j] = 0;
      sample[j] = *samples[j];
      if (!gone[j]) deviation[j] = *samples[j] - planned[j];
    } else if (missing[j] < kLostAfter && ++missing[j] == kLostAfter) {
      gone[j] = true;
    }
    position[j] = there && !gone[j] ? *samples[j] : planned[j] + deviation[j];
    velocity[j] = filter[j].update(position[j], ticks);
  }
}

void Sensing::update(const Reading& reading, const Joints<double>& planned_q, const Joints<double>& planned_theta,
                     int ticks) {
  link_.update(reading.q, planned_q, ticks);
  motor_.update(reading.theta, planned_theta, ticks);
}

void Sensing::Encoders::restart() {
  for (std::size_t j = 0; j < kJoints; ++j) {
    filter[j].reset(position[j], 0);
    velocity[j] = 0;
  }
}

void Sensing::restart() {
  link_.restart();
  motor_.restart();
}

const char* Sensing::lost() const {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (motor_.gone[j]) return kMotors[j];
    if (link_.gone[j]) return kLinks[j];
  }
  return nullptr;
}

void Sensing::trust_again() {
  for (Encoders* encoders : {&link_, &motor_}) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (!encoders->gone[j] || encoders->missing[j] > 0) continue;
      encoders->gone[j] = false;
      encoders->position[j] = encoders->sample[j];
      encoders->filter[j].reset(encoders->sample[j], 0);
    }
  }
}

}  // namespace fjr
