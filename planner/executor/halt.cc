#include "planner/executor/halt.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>

#include "planner/executor/dds/command_port.h"
#include "planner/service/client.h"

namespace fjr {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

bool complied(ExecutorCommand command, ExecutorMode mode) {
  if (mode == ExecutorMode::kStopped) return true;
  return command == ExecutorCommand::kHold && mode == ExecutorMode::kHolding;
}

// The latest state of the robot within a few milliseconds.
std::optional<ExecutorState> listen(dds::CommandPort& port, const std::string& robot_id) {
  port.wait(std::chrono::milliseconds(10));
  std::optional<ExecutorState> latest;
  for (ExecutorState& state : port.take_states()) {
    if (state.robot_id == robot_id) latest = std::move(state);
  }
  return latest;
}

}  // namespace

ExecutorState halt(ExecutorCommand command, const HaltOptions& options) {
  dds::CommandPort port(dds::guarded_participant(options.network));
  const auto began = Clock::now();
  while (!port.heard() || !listen(port, options.robot_id)) {
    if (seconds_since(began) < options.find) continue;
    throw NoAnswer(fmt::format(
        "no executor reports for robot '{}' on DDS domain {} (looked for {:g} s): is `fjr executor` running, on this "
        "domain, for this robot and with the same CYCLONEDDS_URI?",
        options.robot_id, options.network.domain, options.find));
  }
  const ExecutorOrder order{options.robot_id, new_client(), command};
  const auto sent = Clock::now();
  (void)port.send(order);
  for (auto repeated = sent; seconds_since(sent) < options.comply;) {
    const auto state = listen(port, options.robot_id);
    if (state && complied(command, state->mode)) return *state;
    if (seconds_since(repeated) < 0.2) continue;
    repeated = Clock::now();  // commands are idempotent
    (void)port.send(order);
  }
  throw NoAnswer(fmt::format("the executor of robot '{}' does not say within {:g} s that it complies", options.robot_id,
                             options.comply));
}

}  // namespace fjr
