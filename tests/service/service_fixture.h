// A service as its clients see it: real processes, real DDS over the loopback interface.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planner/dds/client_port.h"
#include "tests/support/domain.h"
#include "tests/support/process.h"

namespace fjr {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using testing::HasSubstr;

inline const std::string kFast = "start: {q: [0.3, 0.2]}\ngoal: {q: [0.42, 0.08]}\nobjective: fastest\n";  // 0.1 s
inline const std::string kMedium =
    "start: {q: [0.3, 0.2]}\ngoal: {q: [0.42, 0.08]}\nduration: 1\nobjective: {effort: 1}\nsearch: quick\n";  // 0.6 s
inline const std::string kSlow =
    "start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\nduration: 1.5\nobjective: efficient\n";  // many

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

class ServiceTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override {
    if (HasFailure() && service_) std::fputs(service_->output().c_str(), stderr);
    port_.reset();  // first: it lingers for a second over what a service that is gone has not acknowledged
    service_.reset();
    fs::remove_all(folder_);
  }

  fs::path path(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }

  // Tests that run at the same time, each in its own process, have domains of their own.
  std::string domain() const { return std::to_string(domain_); }

  void serve(const std::string& configuration = "{workers: 1}\n") {
    write("service.yaml", configuration);
    service_ = std::make_unique<Process>(std::vector<std::string>{FJR_EXECUTABLE, "serve", "--domain", domain(),
                                                                  "--config", path("service.yaml").string()},
                                         path("serve.log"));
    connect();
  }

  // To whoever serves.
  void connect() {
    port_ = std::make_unique<dds::ClientPort>(dds::Participant(domain_), me_);
    const auto began = Clock::now();
    while (!port_->served() && seconds_since(began) < 10) port_->wait(milliseconds(5));
    ASSERT_TRUE(port_->served());
  }

  // Waits a little; replies are kept for next(), and what each instance says of itself in heard_.
  virtual void listen() {
    port_->wait(milliseconds(20));
    (void)port_->take_progress();
    for (ServiceStatus& status : port_->take_services()) {
      status_ = status;
      heard_[status.instance] = std::move(status);
    }
    for (Reply& reply : port_->take_replies()) arrived_.push_back(std::move(reply));
  }
  void listen_for(double seconds) {
    for (const auto began = Clock::now(); seconds_since(began) < seconds;) listen();
  }
  // Time for whoever has just started to meet everybody, and to hear of epochs.
  void settle() { listen_for(0.4); }
  // Returns how long it took [s].
  template <class Holds>
  double wait_until(Holds holds, double limit = 20) {
    const auto began = Clock::now();
    while (!holds() && seconds_since(began) < limit) listen();
    EXPECT_TRUE(holds());
    return seconds_since(began);
  }
  // Whether it comes to be said.
  bool says(const Process& process, const std::string& what, std::size_t times = 1) {
    for (const auto began = Clock::now(); count(process.output(), what) < times;) {
      if (seconds_since(began) > 15) return false;
      listen();
    }
    return true;
  }

  Process& service() { return *service_; }

  Process fjr(std::vector<std::string> words, const std::string& log) const {
    words.insert(words.begin(), FJR_EXECUTABLE);
    return Process(words, path(log));
  }
  // At the start of kFast by default. What does not look at a motion under way need not wait for the clock, which a
  // busy machine cannot keep.
  std::unique_ptr<Process> start_executor(const std::string& at = "0.3,0.2",
                                          const std::vector<std::string>& more = {"--fast"}) const {
    std::vector<std::string> words{"executor", "--start", at, "--state", path("state"), "--domain", domain()};
    words.insert(words.end(), more.begin(), more.end());
    return start_fjr(words, "executor");
  }
  std::unique_ptr<Process> start_fjr(std::vector<std::string> words, const std::string& log) const {
    words.insert(words.begin(), FJR_EXECUTABLE);
    return std::make_unique<Process>(words, path(log));
  }

  Order order(const std::string& yaml) {
    Order order;
    order.id = me_;
    order.id.number = ++sent_;
    order.name = "request.yaml";
    order.document = yaml;
    return order;
  }

  RequestId order_sent_last() const { return {me_.client, sent_}; }

  // Again where the service has been kept from taking what came before for longer than a write waits (100 ms).
  void send(const Order& order) {
    bool sent = false;
    for (int i = 0; i < 50 && !sent; ++i) sent = port_->send(order);
    EXPECT_TRUE(sent);
  }
  void cancel(const RequestId& id, const std::string& robot_id = "") { EXPECT_TRUE(port_->cancel(id, robot_id)); }

  void wait_for_executor() {
    port_->follow_executors();
    const auto began = Clock::now();
    while (port_->take_executors().empty() && seconds_since(began) < 10) listen();
  }

  // The next reply to `id` within `limit` seconds of which `wanted` holds.
  template <class Wanted>
  std::optional<Reply> next(const RequestId& id, Wanted wanted, double limit = 20) {
    const auto began = Clock::now();
    while (seconds_since(began) < limit) {
      for (auto reply = arrived_.begin(); reply != arrived_.end(); ++reply) {
        if (reply->id != id || !wanted(*reply)) continue;
        Reply found = *reply;
        // Earlier replies to it are passed over; those to other requests stay to be asked for.
        const auto end = reply + 1;
        arrived_.erase(std::remove_if(arrived_.begin(), end, [&](const Reply& r) { return r.id == id; }), end);
        return found;
      }
      listen();
    }
    ADD_FAILURE() << "no such reply within " << limit << " s";
    return std::nullopt;
  }
  // What an executor says of a trajectory next, within `limit` seconds.
  std::optional<ExecutionResult> result_of(const RequestId& id, double limit = 10) {
    for (const auto began = Clock::now(); seconds_since(began) < limit; listen()) {
      for (ExecutionResult& result : port_->take_results()) {
        if (result.trajectory_id == id) return std::move(result);
      }
    }
    return std::nullopt;
  }

  // The next final one, to whatever request.
  std::optional<Reply> next_final(double limit = 20) {
    for (const auto began = Clock::now(); seconds_since(began) < limit; listen()) {
      const auto found = std::find_if(arrived_.begin(), arrived_.end(), [](const Reply& r) { return r.final(); });
      if (found == arrived_.end()) continue;
      Reply reply = std::move(*found);
      arrived_.erase(found);
      return reply;
    }
    return std::nullopt;
  }
  Reply final_reply(const RequestId& id, double limit = 20) {
    return next(
               id, [](const Reply& reply) { return reply.final(); }, limit)
        .value_or(Reply{});
  }
  void expect_accepted(const RequestId& id) {
    next(id, [](const Reply& reply) { return reply.state == ReplyState::kAccepted; });
  }

  // What the service says of itself once `holds`.
  template <class Holds>
  ServiceStatus status_when(Holds holds, double limit = 5) {
    wait_until([&] { return holds(status_); }, limit);
    return status_;
  }
  void wait_until_solving() {
    status_when([](const ServiceStatus& status) { return status.solving == 1; });
  }

  const unsigned domain_ = own_domain();
  const RequestId me_ = new_client();
  std::map<std::string, ServiceStatus> heard_;  // the last word of each instance

 private:
  fs::path folder_ = fs::temp_directory_path() / ("fjr_service_test_" + std::to_string(::getpid()));
  std::unique_ptr<Process> service_;
  std::unique_ptr<dds::ClientPort> port_;
  std::vector<Reply> arrived_;
  ServiceStatus status_;
  std::uint64_t sent_ = 0;
};

}  // namespace fjr
