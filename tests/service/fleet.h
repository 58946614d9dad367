// A service on several machines, and a client of all of it who counts answers: for tests, and for bench/machines_bench.
#pragma once

#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planner/dds/client_port.h"
#include "tests/support/domain.h"
#include "tests/support/machines.h"

namespace fjr {

class Fleet {
 public:
  using Clock = std::chrono::steady_clock;

  // rehearsal: [s] that a request takes; 0: it is planned.
  Fleet(std::filesystem::path folder, double rehearsal)
      : folder_(std::move(folder)), rehearsal_(rehearsal), network_(folder_) {}

  bool possible() const { return network_.up(); }

  struct Member {
    std::unique_ptr<Switch::Machine> machine;
    std::unique_ptr<Process> process;
    std::string name;
  };
  // An owner or its standby; slots: of its own.
  Member& serve(const std::string& name, int slots) { return start(name, {}, slots); }
  Member& work(const std::string& name, int slots) { return start(name, {"--worker-only"}, slots); }

  // Listens until the owner has so many slots.
  bool has_slots(std::uint32_t slots, double limit = 15) {
    return listen_until([&] { return owner_.epoch > 0 && owner_.workers == slots; }, limit);
  }
  const ServiceStatus& owner() const { return owner_; }

  // Asks for `documents`, `rate` of them a second (0: all at once), and listens until all have been answered. Meanwhile
  // `on_answers(number of answers)` is called.
  struct Asked {
    Order order;
    double asked = 0, heard = 0, answered = -1;  // [s] since the beginning; heard: the last word
    int finals = 0;                              // replies with other bytes than the first are counted as `different`
    Reply reply;
  };
  struct Outcome {
    std::vector<Asked> asked;
    double seconds = 0;  // until the last answer
    std::size_t answered = 0, different = 0;
  };
  Outcome ask(const std::vector<std::string>& documents, double rate, double limit,
              const std::function<void(std::size_t)>& on_answers = {}) {
    connect();
    Outcome outcome;
    const std::uint64_t first = sent_ + 1;
    const auto began = Clock::now();
    const auto now = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
    while (outcome.answered < documents.size() && now() < limit) {
      while (outcome.asked.size() < documents.size() &&
             (rate <= 0 || now() * rate >= static_cast<double>(outcome.asked.size()))) {
        Asked& one = outcome.asked.emplace_back();
        one.order.id = {me_.client, ++sent_};
        one.order.name = "request.yaml";
        one.order.budget = 600;
        one.order.document = documents[outcome.asked.size() - 1];
        one.asked = one.heard = now();
        (void)port_->send(one.order);
      }
      port_->wait(std::chrono::milliseconds(2));
      look_at_services();
      for (Reply& reply : port_->take_replies()) {
        if (reply.id.number < first || reply.id.number - first >= outcome.asked.size()) continue;
        Asked& one = outcome.asked[reply.id.number - first];
        one.heard = now();
        if (!reply.final()) continue;
        if (++one.finals > 1) {
          if (reply.plan_json != one.reply.plan_json || reply.state != one.reply.state) ++outcome.different;
          continue;
        }
        one.answered = now();
        one.reply = std::move(reply);
        ++outcome.answered;
      }
      for (Asked& one : outcome.asked) {  // as clients do
        if (one.finals > 0 || now() - one.heard < 2) continue;
        one.heard = now();
        (void)port_->send(one.order);
      }
      if (on_answers) on_answers(outcome.answered);
    }
    outcome.seconds = now();
    return outcome;
  }

  void connect() {
    if (!port_) port_ = std::make_unique<dds::ClientPort>(dds::Participant(own_domain()), me_);
    (void)listen_until([&] { return port_->served(); }, 15);
  }

 private:
  Member& start(const std::string& name, std::vector<std::string> how, int slots) {
    std::ofstream(folder_ / (name + ".yaml")) << "{instance: " << name << ", queue: 4096, warm_plans: 0}\n";
    Member& member = *members_.emplace_back(std::make_unique<Member>());
    member.name = name;
    member.machine = std::make_unique<Switch::Machine>(network_, static_cast<int>(members_.size()));
    start_again(member, std::move(how), slots);
    return member;
  }
  void start_again(Member& member, std::vector<std::string> how, int slots) {
    how.insert(how.begin(),
               {FJR_EXECUTABLE, "serve", "--insecure-network", "--config", (folder_ / (member.name + ".yaml")).string(),
                "--domain", std::to_string(own_domain()), "--workers", std::to_string(slots)});
    if (rehearsal_ > 0) how.insert(how.end(), {"--rehearse", std::to_string(rehearsal_)});
    member.process = member.machine->start(how, member.name + ".log");
  }

  template <class Holds>
  bool listen_until(Holds holds, double limit) {
    if (!port_) port_ = std::make_unique<dds::ClientPort>(dds::Participant(own_domain()), me_);
    const auto end = Clock::now() + std::chrono::duration<double>(limit);
    while (!holds()) {
      if (Clock::now() > end) return false;
      port_->wait(std::chrono::milliseconds(20));
      look_at_services();
    }
    return true;
  }
  void look_at_services() {
    for (ServiceStatus& status : port_->take_services()) {
      if (status.epoch > 0 && status.epoch >= owner_.epoch) owner_ = std::move(status);
    }
    (void)port_->take_progress();
  }

  const std::filesystem::path folder_;
  const double rehearsal_;
  const Switch network_;
  std::vector<std::unique_ptr<Member>> members_;
  const RequestId me_ = new_client();
  std::uint64_t sent_ = 0;
  ServiceStatus owner_;
  std::unique_ptr<dds::ClientPort> port_;
};

}  // namespace fjr
