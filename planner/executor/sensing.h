// Computes positions and velocities in every tick from the readings, and bridges missing samples.
#pragma once

#include "model/encoder.h"
#include "planner/control/motor_feedback.h"
#include "planner/executor/arm.h"

namespace fjr {

inline constexpr int kLostAfter = 3;  // an encoder is lost after so many missing samples in a row

class Sensing {
 public:
  explicit Sensing(const Parameters& robot);

  // Starts at rest at these positions [rad].
  void start(const Joints<double>& q, const Joints<double>& theta);

  // Processes the readings of a tick, which is `ticks` after the last one, more than 1 if ticks were missed. A missing
  // sample is replaced by the planned value plus the last known deviation from the plan.
  void update(const Reading& reading, const Joints<double>& planned_q, const Joints<double>& planned_theta,
              int ticks = 1);

  const Joints<double>& q() const { return link_.position; }
  const Joints<double>& theta() const { return motor_.position; }
  const Joints<double>& dq() const { return link_.velocity; }
  const Joints<double>& dtheta() const { return motor_.velocity; }

  Joints<bool> motors_lost() const { return motor_.gone; }
  const char* lost() const;  // "theta1", ...; null: none
  void trust_again();        // encoders that give samples again are no longer lost
  void restart();            // resets the velocities to 0, because after a gap in time differences are meaningless

 private:
  struct Encoders {
    Joints<double> position{}, velocity{}, sample{}, deviation{};
    Joints<int> missing{};
    Joints<bool> gone{};
    Joints<VelocityFilter> filter;

    void update(const Joints<std::optional<double>>& samples, const Joints<double>& planned, int ticks);
    void restart();
  };

  Encoders link_, motor_;
};

}  // namespace fjr
