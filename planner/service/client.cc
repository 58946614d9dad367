#include "planner/service/client.h"

#include <fmt/format.h>

#include <chrono>
#include <map>
#include <optional>

#include "planner/service/dds/client_port.h"

namespace fjr {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kCancelPatience = 3;  // [s] for the answer to a cancellation

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

class Client {
 public:
  Client(const Order& order, const ClientOptions& options)
      : order_(order), options_(options), port_(options.domain, order.id) {}

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
    const auto began = Clock::now();
    while (!port_.served()) {
      if (seconds_since(began) > options_.find || cancelled()) {
        throw NoAnswer(fmt::format(
            "nobody serves plan requests on DDS domain {} (looked for {:g} s): is `fjr serve` running, on this domain "
            "and with the same CYCLONEDDS_URI?",
            options_.domain, options_.find));
      }
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
    if (!order_.execute || answer.reply.state != ReplyState::kSolved) return answer;
    const double patience = answer.reply.rows.back().time + options_.execution;
    for (const auto began = Clock::now(); seconds_since(began) < patience && !cancelled();) {
      for (ExecutionResult& result : port_.take_results()) {
        if (result.trajectory_id == order_.id) {
          answer.result = std::move(result);
          return answer;
        }
      }
      port_.wait(std::chrono::milliseconds(20));
      (void)port_.take_replies();
      (void)port_.take_services();
    }
    throw NoAnswer("the trajectory was published, but no executor has reported: is `fjr executor` running?");
  }

  void cancel_if_asked() {
    if (!cancelled()) return;
    if (!cancelled_at_) {
      cancelled_at_ = Clock::now();
      port_.cancel(order_.id);
    }
    if (seconds_since(*cancelled_at_) > kCancelPatience) throw NoAnswer("the service does not answer the cancellation");
  }

  void ask_again_if_silent() {
    if (seconds_since(last_heard_) > options_.silence) throw NoAnswer(about_the_silence());
    if (seconds_since(last_heard_) < options_.ask_again || seconds_since(last_sent_) < options_.ask_again) return;
    last_sent_ = Clock::now();
    port_.send(order_);
  }

  std::string about_the_silence() const {
    if (!port_.served()) {
      return fmt::format("the service went away before it answered, and nobody else serves on DDS domain {}",
                         options_.domain);
    }
    return fmt::format(
        "a service takes requests on DDS domain {} but has not answered for {:g} s: it hangs, or its version has other "
        "types",
        options_.domain, options_.silence);
  }

  const Order& order_;
  const ClientOptions& options_;
  dds::ClientPort port_;
  Clock::time_point last_heard_, last_sent_;
  std::optional<Clock::time_point> cancelled_at_;
};

}  // namespace

Answer request_plan(const Order& order, const ClientOptions& options) { return Client(order, options).run(); }

std::vector<ServiceStatus> find_services(unsigned domain, double wait) {
  dds::ClientPort port(domain, new_client());
  std::map<std::string, ServiceStatus> latest;
  for (const auto began = Clock::now(); seconds_since(began) < wait;) {
    port.wait(std::chrono::milliseconds(20));
    for (ServiceStatus& status : port.take_services()) latest[status.instance] = std::move(status);
  }
  std::vector<ServiceStatus> services;
  for (auto& [instance, status] : latest) services.push_back(std::move(status));
  return services;
}

}  // namespace fjr
