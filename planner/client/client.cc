#include "planner/client/client.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <utility>

#include "planner/client/patience.h"
#include "planner/dds/client_port.h"
#include "planner/dds/overview_port.h"

namespace fjr {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kCancelPatience = 3;  // [s] for the answer to a cancellation
constexpr std::chrono::milliseconds kCancelAgain{500};

class Client {
 public:
  Client(const Order& order, const ClientOptions& options)
      : order_(order), options_(options), port_(dds::guarded_participant(options.network), order.id) {}

  Answer run() {
    find_service();
    port_.send(order_);
    last_heard_ = last_sent_ = Clock::now();
    for (;;) {
      port_.wait(std::chrono::milliseconds(50));
      if (auto reply = listen()) return with_execution(std::move(*reply));
      cancel_if_asked();
      ask_again_if_silent();
    }
  }

 private:
  bool cancelled() const { return options_.cancelled && options_.cancelled(); }

  void find_service() {
    Patience patience(options_.find);
    while (!port_.served()) {
      if (port_.discovery().look()) patience.progressed();
      if (cancelled()) throw NobodyAsked(about_nobody(patience.looked()));
      if (patience.over(port_.discovery().handshakes_may_take())) throw NoAnswer(about_nobody(patience.looked()));
      port_.wait(std::chrono::milliseconds(5));
      (void)port_.take_services();
    }
  }

  std::optional<Reply> listen() {
    (void)port_.take_services();
    for (const ProgressReport& report : port_.take_progress()) {
      if (report.id != order_.id) continue;
      last_heard_ = Clock::now();
      if (options_.on_progress) options_.on_progress(report);
    }
    for (Reply& reply : port_.take_replies()) {
      if (reply.id != order_.id) continue;
      last_heard_ = Clock::now();
      if (reply.final()) return std::move(reply);
    }
    return std::nullopt;
  }

  Answer with_execution(Reply reply) {
    Answer answer{std::move(reply), {}};
    if (order_.action == Action::kPlan || answer.reply.state != ReplyState::kSolved) return answer;
    const double duration = answer.reply.rows.back().time;
    port_.follow_executors();
    for (const auto began = Clock::now(); !abandoned(answer.reply);) {
      for (ExecutionResult& result : port_.take_results()) {
        if (result.trajectory_id == order_.id) {
          answer.result = std::move(result);
          return answer;
        }
      }
      follow(duration);
      if (Patience::since(began) > options_.find && !port_.any_executor()) {
        throw NoExecutionResult(about_no_executor(duration), std::move(answer.reply));
      }
      if (Patience::since(began) > duration + options_.execution) {
        throw NoExecutionResult(
            "the trajectory was published, but the executor has not reported: is it for the same robot?",
            std::move(answer.reply));
      }
      port_.wait(std::chrono::milliseconds(20));
      (void)port_.take_replies();
      (void)port_.take_services();
    }
    throw NoExecutionResult("the trajectory was published, and its execution goes on: it was not waited for",
                            std::move(answer.reply));
  }

  std::string about_no_executor(double duration) const {
    if (executed_until_) {
      return fmt::format(
          "the executor went silent {:.3g} s into the motion of {:.3g} s: nobody reports where the arm is",
          *executed_until_, duration);
    }
    return fmt::format(
        "the trajectory was published, but there is no executor on DDS domain {}: is `fjr executor` running?",
        options_.network.domain);
  }

  // Returns true if the request is cancelled and this client is not to stop the arm. Throws NoExecutionResult if the
  // arm cannot be stopped.
  bool abandoned(const Reply& reply) {
    if (!cancelled() || stopped_) return false;
    if (!options_.stop_execution) return true;
    try {
      options_.stop_execution(reply.robot_id);
    } catch (const std::exception& error) {
      throw NoExecutionResult(fmt::format("cancelled after the trajectory was published: {}", error.what()), reply);
    }
    stopped_ = true;
    return false;
  }

  void follow(double duration) {
    for (const ExecutorState& state : port_.take_executors()) {
      if (state.trajectory_id != order_.id) continue;
      if (state.mode != ExecutorMode::kPreparing) executed_until_ = std::min(state.time, duration);
      if (!options_.on_execution) continue;
      options_.on_execution({std::min(state.time, duration),
                             duration,
                             {state.q[0] - state.planned_q[0], state.q[1] - state.planned_q[1]},
                             state});
    }
  }

  // The cancellation may have reached nobody, or an instance that is gone now. It is idempotent, so it is repeated.
  void cancel_if_asked() {
    if (!cancelled()) return;
    const auto now = Clock::now();
    if (!cancelled_at_) cancelled_at_ = now;
    if (now - last_cancel_ > kCancelAgain) {
      last_cancel_ = now;
      port_.cancel(order_.id, order_.robot_id);
    }
    if (Patience::since(*cancelled_at_) > kCancelPatience)
      throw NoAnswer("the service does not answer the cancellation");
  }

  void ask_again_if_silent() {
    if (Patience::since(last_heard_) > options_.silence) throw NoAnswer(about_the_silence());
    if (Patience::since(last_heard_) < options_.ask_again || Patience::since(last_sent_) < options_.ask_again) return;
    last_sent_ = Clock::now();
    port_.send(order_);
  }

  std::string about_nobody(double looked) {
    if (const auto why = port_.why_unserved()) {
      return fmt::format("nobody on DDS domain {} can take this program's requests: {}", options_.network.domain, *why);
    }
    const auto strangers = port_.discovery().about_strangers();
    return fmt::format("nobody serves plan requests on DDS domain {} (looked for {:.3g} s): {}",
                       options_.network.domain, looked,
                       strangers.value_or("is `fjr serve` running, on this domain and with the same CYCLONEDDS_URI?"));
  }

  std::string about_the_silence() const {
    if (!port_.served()) {
      return fmt::format("the service went away before it answered, and nobody else serves on DDS domain {}",
                         options_.network.domain);
    }
    if (const auto why = port_.why_unanswered()) {
      return fmt::format("a service takes requests on DDS domain {}, but its replies cannot be read: {}",
                         options_.network.domain, *why);
    }
    return fmt::format(
        "a service takes requests on DDS domain {} but has not answered for {:g} s: it hangs, it was killed, or its "
        "version has other types",
        options_.network.domain, options_.silence);
  }

  const Order& order_;
  const ClientOptions& options_;
  dds::ClientPort port_;
  Clock::time_point last_heard_, last_sent_, last_cancel_;
  std::optional<Clock::time_point> cancelled_at_;
  std::optional<double> executed_until_;  // [s] of the motion; none: no executor has said that it runs it
  bool stopped_ = false;
};

}  // namespace

Answer request_plan(const Order& order, const ClientOptions& options) { return Client(order, options).run(); }

struct Lookout::Seen {
  explicit Seen(const Network& network) : port(dds::Participant(network.domain, network.security)) {}

  dds::OverviewPort port;
  std::map<std::string, ArmDrift> drifts;
};

Lookout::Lookout(const Network& network) : seen_(std::make_unique<Seen>(network)) {}
Lookout::~Lookout() = default;

Overview Lookout::look(double wait, const std::function<bool()>& enough) {
  auto& [port, drifts] = *seen_;
  std::map<std::string, ServiceStatus> services;
  std::map<std::pair<std::string, dds::ExecutorStates::Source>, ExecutorState> executors;
  Patience patience(wait);
  const auto still_looking = [&] {
    return patience.looked() < wait ||
           (services.empty() && executors.empty() && !patience.over(port.discovery().handshakes_may_take()));
  };
  while (still_looking() && !(enough && enough())) {
    port.wait(std::chrono::milliseconds(20));
    if (port.discovery().look()) patience.progressed();
    for (ServiceStatus& status : port.take_services()) services[status.instance] = std::move(status);
    for (ArmDrift& drift : port.take_drifts()) drifts[drift.robot_id] = std::move(drift);
    for (auto& [source, state] : port.take_executors()) executors[{state.robot_id, source}] = std::move(state);
  }
  Overview found;
  for (auto& [instance, status] : services) found.services.push_back(std::move(status));
  for (const auto& [robot, drift] : drifts) found.drifts.push_back(drift);
  for (auto& [robot, state] : executors) found.executors.push_back(std::move(state));
  if (found.services.empty()) found.strangers = port.discovery().about_strangers();
  found.looked = patience.looked();
  return found;
}

Overview overview(const Network& network, double wait) { return Lookout(network).look(wait); }

}  // namespace fjr
