// From readings to positions and velocities of every tick, samples that did not arrive included.
#pragma once

#include "model/encoder.h"
#include "planner/control/motor_feedback.h"
#include "planner/executor/arm.h"

namespace fjr {

inline constexpr int kLostAfter = 3;  // samples missing in a row: the encoder is lost

class Sensing {
 public:
  explicit Sensing(const Parameters& robot);

  // At rest at these positions. [rad]
  void start(const Pair<double>& q, const Pair<double>& theta);

  // A sample that is missing is bridged: the plan's value and how far from it the last one was.
  void update(const Reading& reading, const Pair<double>& planned_q, const Pair<double>& planned_theta);

  const Pair<double>& q() const { return link_.position; }
  const Pair<double>& theta() const { return motor_.position; }
  const Pair<double>& dq() const { return link_.velocity; }
  const Pair<double>& dtheta() const { return motor_.velocity; }

  Pair<bool> motors_lost() const { return motor_.gone; }
  const char* lost() const;  // "theta1", ...; null: none
  void trust_again();        // what has samples again is no longer lost
  void restart();            // at rest where it is: after a gap in time, differences say nothing about velocities

 private:
  struct Encoders {
    Pair<double> position{}, velocity{}, sample{}, deviation{};
    Pair<int> missing{};
    Pair<bool> gone{};
    Pair<VelocityFilter> filter;

    void update(const Pair<std::optional<double>>& samples, const Pair<double>& planned);
    void restart();
  };

  Encoders link_, motor_;
};

}  // namespace fjr
