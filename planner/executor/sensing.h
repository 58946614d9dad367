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
  void start(const Joints<double>& q, const Joints<double>& theta);

  // A sample that is missing is bridged: the plan's value and how far from it the last one was.
  void update(const Reading& reading, const Joints<double>& planned_q, const Joints<double>& planned_theta);

  const Joints<double>& q() const { return link_.position; }
  const Joints<double>& theta() const { return motor_.position; }
  const Joints<double>& dq() const { return link_.velocity; }
  const Joints<double>& dtheta() const { return motor_.velocity; }

  Joints<bool> motors_lost() const { return motor_.gone; }
  const char* lost() const;  // "theta1", ...; null: none
  void trust_again();        // what has samples again is no longer lost
  void restart();            // at rest where it is: after a gap in time, differences say nothing about velocities

 private:
  struct Encoders {
    Joints<double> position{}, velocity{}, sample{}, deviation{};
    Joints<int> missing{};
    Joints<bool> gone{};
    Joints<VelocityFilter> filter;

    void update(const Joints<std::optional<double>>& samples, const Joints<double>& planned);
    void restart();
  };

  Encoders link_, motor_;
};

}  // namespace fjr
