#include "planner/client/halt.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <set>

#include "planner/client/client.h"
#include "planner/client/patience.h"
#include "planner/dds/command_port.h"

namespace fjr {
namespace {

using Clock = std::chrono::steady_clock;
using Source = dds::ExecutorStates::Source;

constexpr double kAgain = 0.1;   // [s] between repetitions: commands are idempotent
constexpr double kObey = 0.05;   // [s] after the arrival of a command, from which on states reflect it
constexpr double kQuiet = 0.25;  // [s] without a new participant, after which all count as known
constexpr double kMeeting =
    0.5;  // [s] for a reader of commands to appear as a writer of states, too; otherwise it is no executor

const char* verb(ExecutorCommand command) { return command == ExecutorCommand::kStop ? "stop" : "hold"; }

class Halt {
 public:
  Halt(ExecutorCommand command, const HaltOptions& options)
      : options_(options),
        order_{options.robot_id, new_client(), command},
        port_(dds::guarded_participant(options.network)),
        patience_(options.find) {}

  std::vector<ExecutorState> run() {
    for (;;) {
      port_.wait(std::chrono::milliseconds(5));
      send();
      listen();
      if (everybody_complied()) return complied_states();
      if (!answered() && patience_.over(port_.discovery().handshakes_may_take())) throw NoAnswer(about_nobody());
      if (answered() && patience_.looked() > options_.comply) throw NoAnswer(about_the_others());
    }
  }

 private:
  // Sends the command to the readers known by now, and at once again when a new one is discovered.
  void send() {
    const std::size_t readers = port_.readers();
    if (readers > readers_) delivered_.reset();
    if (readers > readers_ || (readers > 0 && Patience::since(sent_) > kAgain)) {
      sent_ = Clock::now();
      (void)port_.send(order_);
      ++times_;
    }
    readers_ = readers;
    if (times_ > 0 && !delivered_ && port_.delivered()) delivered_ = Clock::now();
  }

  void listen() {
    if (port_.discovery().look()) patience_.progressed();
    for (auto& [source, state] : port_.executors().take()) {
      if (const auto peer = port_.executors().peer(source)) heard_of_.insert(*peer);
      if (state.robot_id != options_.robot_id) continue;
      const bool after = delivered_ && Patience::since(*delivered_) > kObey;
      states_.insert_or_assign(source, Word{state, after && complied(state.mode)});
    }
    std::erase_if(states_, [this](const auto& word) { return !port_.executors().there(word.first); });
  }

  bool complied(ExecutorMode mode) const {
    if (mode == ExecutorMode::kStopped) return true;
    return order_.command == ExecutorCommand::kHold && mode == ExecutorMode::kHolding;
  }

  bool answered() const { return !states_.empty(); }

  bool everybody_complied() {
    const bool everybody_known = patience_.nothing_new() > kQuiet || patience_.looked() > options_.find;
    return answered() && everybody_known && silent() == 0 &&
           std::all_of(states_.begin(), states_.end(), [](const auto& word) { return word.second.complied; });
  }

  // Returns the number of participants whose robot is still unknown and that write states or, for kMeeting after they
  // were discovered, read commands.
  std::size_t silent() {
    const auto& peers = port_.discovery().peers();
    return static_cast<std::size_t>(std::count_if(peers.begin(), peers.end(), [this](const auto& entry) {
      const auto& [key, peer] = entry;
      if (heard_of_.contains(key)) return false;
      if (dds::CommandPort::reports_states(peer)) return true;
      return dds::CommandPort::takes_commands(peer) && Patience::since(peer.met) < kMeeting;
    }));
  }

  std::vector<ExecutorState> complied_states() const {
    std::vector<ExecutorState> states;
    for (const auto& [source, word] : states_) states.push_back(word.state);
    return states;
  }

  std::string what_was_sent() const {
    if (times_ == 0) return fmt::format("{} could not be sent, for nobody takes commands,", verb(order_.command));
    return fmt::format("{} was sent {} times to {} reader{} of commands{}", verb(order_.command), times_, readers_,
                       readers_ == 1 ? "" : "s", delivered_ ? ", arrived," : "");
  }

  std::string about_nobody() {
    const auto strangers = port_.discovery().about_strangers();
    return fmt::format(
        "{} and no executor reports for robot '{}' on DDS domain {} (looked for {:.1f} s): {}", what_was_sent(),
        options_.robot_id, options_.network.domain, patience_.looked(),
        strangers.value_or(
            "is `fjr executor` running, on this domain, for this robot and with the same CYCLONEDDS_URI?"));
  }

  std::string about_the_others() {
    const auto complied =
        std::count_if(states_.begin(), states_.end(), [](const auto& word) { return word.second.complied; });
    std::string text =
        fmt::format("{} but {} of {} executors of robot '{}' say{} within {:g} s that it complies", what_was_sent(),
                    complied, states_.size(), options_.robot_id, complied == 1 ? "s" : "", options_.comply);
    if (const std::size_t others = silent(); others > 0) {
      text += fmt::format("; {} more say{} nothing of itself", others, others == 1 ? "s" : "");
    }
    return text;
  }

  struct Word {
    ExecutorState state;
    bool complied;  // whether a state after the arrival of the command shows it
  };

  const HaltOptions& options_;
  const ExecutorOrder order_;
  dds::CommandPort port_;
  Patience patience_;
  std::size_t readers_ = 0;
  int times_ = 0;
  Clock::time_point sent_;
  std::optional<Clock::time_point> delivered_;
  std::set<dds::Discovery::Key> heard_of_;
  std::map<Source, Word> states_;  // the latest state of each executor of the robot
};

}  // namespace

std::vector<ExecutorState> halt(ExecutorCommand command, const HaltOptions& options) {
  return Halt(command, options).run();
}

}  // namespace fjr
