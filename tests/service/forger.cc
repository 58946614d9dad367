// Somebody on the network who would move the arm:  forger DOMAIN SECONDS
// Publishes a trajectory to whoever takes trajectories. Prints what came of it: matched=1 moved=0.123 (rad, link 1).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "planner/dds/reader.h"
#include "planner/dds/wire_execution.h"
#include "planner/dds/writer.h"
#include "tests/executor/flat_motion.h"
#include "tests/support/service_processes.h"

int main(int, char** argv) {
  using namespace fjr;
  const Parameters robot = load_parameters(default_robot_file());
  TrajectoryOrder order;
  order.robot_id = "arm";
  order.id = new_client();
  order.robot_hash = robot_hash(robot);
  order.certified = order.ends_at_rest = true;
  order.rows = flat_motion(robot, {0, 0}, {0.2, 0}, 0.5).samples;

  const dds::Participant participant(static_cast<unsigned>(std::atoi(argv[1])));
  dds::Reader<fjr_msg_ExecutorState> states(participant, participant.handle());
  dds::Writer<fjr_msg_Trajectory> trajectories(participant, participant.handle());
  std::optional<double> from;
  double moved = 0;
  bool matched = false;
  (void)comes_true(
      [&] {
        states.take_all([&](const fjr_msg_ExecutorState& state, const dds_sample_info_t& info) {
          if (!info.valid_data) return;
          if (!from) from = state.q[0];
          moved = std::max(moved, std::abs(state.q[0] - *from));
        });
        if (from && !matched && trajectories.has_reader()) {
          const auto now = std::chrono::system_clock::now().time_since_epoch();
          order.published = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
          matched = trajectories.write(dds::encode(order));
        }
        return false;
      },
      std::atof(argv[2]));
  fmt::print("matched={:d} moved={:.3f}\n", matched, moved);
}
