// What the planning service costs beyond planning: real processes over DDS on the loopback interface.
//   build/bench/service_bench [--json FILE]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <stop_token>

#include "planner/dds/client_port.h"
#include "planner/dds/wire_execution.h"
#include "planner/executor/executor_config.h"
#include "planner/executor/realtime.h"
#include "planner/stop/stop_motion.h"
#include "tests/executor/flat_motion.h"
#include "tests/support/domain.h"
#include "tests/support/process.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using Json = nlohmann::ordered_json;

const std::string kQuick = "start: {q: [0.3, 0.2]}\ngoal: {q: [0.42, 0.08]}\nobjective: fastest\n";
const std::string kSlow = "start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\nduration: 1.5\nobjective: efficient\n";
const std::string kRefused = "start: {q: [0, 0]}\ngoal: {q: [1.2, 3.4]}\n";

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double quantile(std::vector<double> values, double fraction) {
  if (values.empty()) throw std::runtime_error("nothing was measured");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1) + 0.5)];
}

struct Options {
  std::size_t requests = 200;
  double seconds = 10;  // of executor ticks
  std::string json;
};

// The lines of the table: name, value, unit, and what is wanted of it.
class Report {
 public:
  void add(const std::string& name, double value, const std::string& unit, std::optional<double> at_most = {}) {
    fmt::print("{:<44}{:>12.4g} {:<12}{}\n", name, value, unit,
               at_most ? fmt::format("{} {:g}", value <= *at_most ? "ok, at most" : "MISSED, at most", *at_most) : "");
    std::fflush(stdout);
    Json line = {{"name", name}, {"value", value}, {"unit", unit}};
    if (at_most) line["at_most"] = *at_most;
    lines_.push_back(line);
  }
  void distribution(const std::string& name, std::vector<double> values, const std::string& unit,
                    std::optional<double> median = {}, std::optional<double> p99 = {}) {
    add(name + ", median", quantile(values, 0.5), unit, median);
    add(name + ", p99", quantile(values, 0.99), unit, p99);
    add(name + ", max", quantile(values, 1), unit);
  }
  void write(const std::string& file) const { std::ofstream(file) << lines_.dump(2) << "\n"; }

 private:
  Json lines_ = Json::array();
};

std::unique_ptr<Process> start(std::vector<std::string> words, const fs::path& log) {
  words.insert(words.begin(), FJR_EXECUTABLE);
  words.insert(words.end(), {"--domain", std::to_string(own_domain())});
  return std::make_unique<Process>(words, log);
}

// A service, and a client in this process.
class Rig {
 public:
  Rig(int workers, const fs::path& log)
      : service_(start({"serve", "--workers", std::to_string(workers)}, log)),
        port_(dds::Participant(own_domain()), me_) {
    const auto began = Clock::now();
    while (!port_.served() || status_.instance.empty()) {
      if (seconds_since(began) > 20) throw std::runtime_error("the service does not start:\n" + service_->output());
      turn();
    }
  }

  Order order(const std::string& yaml, bool execute = false) {
    Order order;
    order.id = me_;
    order.id.number = ++count_;
    order.name = "bench.yaml";
    order.document = yaml;
    order.action = execute ? Action::kPlanAndExecute : Action::kPlan;
    return order;
  }

  void send(const Order& order) {
    if (!port_.send(order)) throw std::runtime_error("the service takes no requests");
  }
  void cancel(const RequestId& id) { port_.cancel(id); }

  // What arrives next, after at most 20 ms.
  std::vector<Reply> turn() {
    port_.wait(milliseconds(20));
    (void)port_.take_progress();
    for (ServiceStatus& status : port_.take_services()) status_ = std::move(status);
    return port_.take_replies();
  }

  Reply final_reply(const RequestId& id) {
    for (const auto began = Clock::now(); seconds_since(began) < 60;) {
      for (Reply& reply : turn()) {
        if (reply.id == id && reply.final()) return std::move(reply);
      }
    }
    throw std::runtime_error("no reply:\n" + service_->output());
  }

  const ServiceStatus& status() const { return status_; }
  const Process& service() const { return *service_; }

 private:
  std::unique_ptr<Process> service_;
  const RequestId me_ = new_client();
  dds::ClientPort port_;
  ServiceStatus status_;
  std::uint64_t count_ = 0;
};

// From the request's writing to the trajectory's arrival where an executor would be, less the planner's own time.
void overhead(Report& report, const Options& options, const fs::path& log) {
  Rig rig(1, log);
  const dds::Participant participant(own_domain());
  dds::Waitset waitset(participant);
  dds::Reader<fjr_msg_Trajectory> trajectories(participant, participant.handle());
  waitset.attach(trajectories.arrived());
  std::this_thread::sleep_for(milliseconds(300));  // to be discovered
  std::vector<double> beyond, in_worker, round_trip;
  for (std::size_t i = 0; i < options.requests; ++i) {
    const Order order = rig.order(kQuick, true);
    std::optional<Clock::time_point> arrived;
    const auto sent = Clock::now();
    rig.send(order);
    while (!arrived && seconds_since(sent) < 60) {
      waitset.wait(milliseconds(100));
      trajectories.take_all([&](const fjr_msg_Trajectory& trajectory, const dds_sample_info_t& info) {
        if (info.valid_data && dds::decode(trajectory).id == order.id) arrived = Clock::now();
      });
    }
    if (!arrived) throw std::runtime_error("no trajectory:\n" + rig.service().output());
    const Reply reply = rig.final_reply(order.id);
    const double planning = Json::parse(reply.plan_json).at("timing").at("total");
    beyond.push_back(1e3 * (std::chrono::duration<double>(*arrived - sent).count() - planning));
    in_worker.push_back(1e3 * (reply.solve_time - planning));

    const Order refused = rig.order(kRefused);
    const auto asked = Clock::now();
    rig.send(refused);
    (void)rig.final_reply(refused.id);
    round_trip.push_back(1e3 * seconds_since(asked));
  }
  report.distribution("request to trajectory beyond planning", beyond, "ms", 1, 10);
  report.distribution("  of which to the worker and back", in_worker, "ms");
  report.distribution("round trip of a refused request", round_trip, "ms");
}

// Two requests wait or are solved for each worker, so that none is ever idle.
void throughput(Report& report, const Options& options, int workers, const fs::path& log) {
  Rig rig(workers, log);
  const std::size_t count = std::max<std::size_t>(4, options.requests / 5);
  std::size_t sent = 0, answered = 0;
  const auto began = Clock::now();
  while (answered < count) {
    while (sent < count && sent < answered + 2 * static_cast<std::size_t>(workers)) {
      rig.send(rig.order(kQuick));
      ++sent;
    }
    for (const Reply& reply : rig.turn()) answered += reply.final() ? 1 : 0;
    if (seconds_since(began) > 600) throw std::runtime_error("replies are missing:\n" + rig.service().output());
  }
  report.add(fmt::format("requests solved, {} worker{}", workers, workers == 1 ? "" : "s"),
             static_cast<double>(count) / seconds_since(began), "1/s");
}

void cancelling(Report& report, const Options& options, const fs::path& log) {
  Rig rig(1, log);
  std::vector<double> latency;
  for (std::size_t i = 0; i < std::max<std::size_t>(2, options.requests / 10); ++i) {
    const Order order = rig.order(kSlow);
    rig.send(order);
    for (const auto began = Clock::now(); seconds_since(began) < 0.5 + 0.01 * static_cast<double>(i);) (void)rig.turn();
    const auto asked = Clock::now();
    rig.cancel(order.id);
    if (rig.final_reply(order.id).state != ReplyState::kCancelled) throw std::runtime_error("not cancelled");
    latency.push_back(1e3 * seconds_since(asked));
  }
  report.distribution("cancel in mid-solve to reply", latency, "ms", {}, 50);
}

void memory(Report& report, const fs::path& log) {
  Rig rig(4, log);
  std::vector<RequestId> asked;
  for (int i = 0; i < 8; ++i) {
    const Order order = rig.order(kQuick);
    rig.send(order);
    asked.push_back(order.id);
  }
  std::size_t answered = 0;
  for (const auto began = Clock::now(); answered < asked.size() && seconds_since(began) < 60;) {
    for (const Reply& reply : rig.turn()) answered += reply.final() ? 1 : 0;
  }
  const auto told = Clock::now();
  while (seconds_since(told) < 0.5) (void)rig.turn();  // a heartbeat later than the last reply
  report.add("resident memory with 4 workers", static_cast<double>(rig.status().memory) / 1e6, "MB", 200);
}

// The stamps of fjr/executor_state, one a tick. With a long history, so that none is lost to our own tardiness.
std::vector<std::int64_t> state_stamps(double seconds, const Process& executor) {
  const dds::Participant participant(own_domain());
  const dds::Entity topic = participant.topic<fjr_msg_ExecutorState>();
  const dds::Entity reader(
      dds_create_reader(participant.handle(), topic.handle(), dds::Qos().best_effort().keep_last(1000).get(), nullptr),
      "reader");
  std::vector<std::int64_t> stamps;
  std::optional<Clock::time_point> first;
  for (const auto began = Clock::now(); !first || seconds_since(*first) < seconds;) {
    std::this_thread::sleep_for(milliseconds(20));
    std::array<fjr_msg_ExecutorState, 64> states{};
    std::array<dds_sample_info_t, 64> infos{};
    std::array<void*, 64> places{};
    for (std::size_t i = 0; i < places.size(); ++i) places[i] = &states[i];
    const dds_return_t count = dds_take(reader.handle(), places.data(), infos.data(), places.size(), places.size());
    for (std::size_t i = 0; i < static_cast<std::size_t>(std::max(count, 0)); ++i) {
      if (infos[i].valid_data) stamps.push_back(states[i].stamp);
    }
    if (!first && !stamps.empty()) first = Clock::now();
    if (!first && seconds_since(began) > 20) throw std::runtime_error("no executor:\n" + executor.output());
  }
  return stamps;
}

// The executor's clock and priority with nothing to do: what is late here is late by the machine.
Lateness bare_loop(const std::stop_token& over) {
  (void)become_realtime(ExecutorConfig().priority);
  Metronome metronome(1e-3);
  Lateness lateness;
  while (!over.stop_requested()) (void)metronome.wait(lateness);
  return lateness;
}

// Lateness of states is against the earliest of the tenth of a second around it; a skipped tick makes the rest of it
// late.
void ticks(Report& report, const Options& options, const fs::path& log) {
  constexpr double kTick = 1e6;  // [ns]
  constexpr std::size_t kWindow = 100;
  const auto executor = start({"executor", "--state", log.string() + ".state"}, log);
  std::stop_source over;
  auto beside = std::async(std::launch::async, bare_loop, over.get_token());
  const std::vector<std::int64_t> stamps = state_stamps(options.seconds, *executor);
  over.request_stop();
  const Lateness bare = beside.get();
  std::vector<double> lateness;
  for (std::size_t begin = 0; begin < stamps.size(); begin += kWindow) {
    std::vector<double> offset;
    for (std::size_t i = begin; i < std::min(begin + kWindow, stamps.size()); ++i) {
      offset.push_back(static_cast<double>(stamps[i] - stamps[begin]) - static_cast<double>(i - begin) * kTick);
    }
    const double earliest = *std::min_element(offset.begin(), offset.end());
    for (const double value : offset) lateness.push_back(1e-3 * (value - earliest));
  }
  executor->send(SIGTERM);
  (void)executor->wait();
  const std::string log_text = executor->output();
  const std::size_t said = log_text.find("late by ");
  double p99 = 0, largest = 0;
  if (said == std::string::npos ||
      std::sscanf(log_text.c_str() + said, "late by %lf us at p99, %lf us at most", &p99, &largest) != 2) {
    throw std::runtime_error("the executor does not tell how late it was:\n" + log_text);
  }
  report.add("executor tick lateness, p99", p99, "us");
  report.add("executor tick lateness, max", largest, "us");
  report.add("a bare loop beside it, p99", 1e6 * bare.quantile(0.99), "us");
  report.add("a bare loop beside it, max", 1e6 * bare.largest(), "us");
  report.distribution("executor state lateness", lateness, "us");
  report.add("executor ticks a second",
             1e9 * static_cast<double>(stamps.size() - 1) / static_cast<double>(stamps.back() - stamps.front()), "1/s");
}

// What an executor is told of a motion, and what it says: as a service would, with the motion's stops.
class Publisher {
 public:
  Publisher() : participant_(own_domain()) { waitset_.attach(states_.arrived()); }

  // Waits until `holds` of the executor's last word.
  template <class Holds>
  void wait_until(Holds&& holds, const Process& executor) {
    const auto began = Clock::now();
    while (state_.robot_id.empty() || !trajectories_.has_reader() || !holds(state_)) {
      if (seconds_since(began) > 60) throw std::runtime_error("not within 60 s:\n" + executor.output());
      waitset_.wait(milliseconds(5));
      states_.take_all([&](const fjr_msg_ExecutorState& message, const dds_sample_info_t& info) {
        if (info.valid_data) state_ = dds::decode(message);
      });
    }
  }
  void publish(TrajectoryOrder order) {
    order.id = new_client();
    order.published = state_.stamp;
    if (!trajectories_.write(dds::encode_2(order))) throw std::runtime_error("the executor takes no trajectory");
  }

 private:
  dds::Participant participant_;
  dds::Waitset waitset_{participant_};
  dds::Reader<fjr_msg_ExecutorState> states_{participant_, participant_.handle()};
  dds::Writer<fjr_msg_Trajectory2> trajectories_{participant_, participant_.handle()};
  ExecutorState state_;
};

// From a motion's publication to the first word that it runs, each time of another executor.
void starts(Report& report, const Options& options, const fs::path& log) {
  const Parameters robot = load_parameters(default_robot_file());
  TrajectoryOrder order;
  order.robot_id = "arm";
  order.robot_hash = robot_hash(robot);
  order.certified = order.ends_at_rest = true;
  order.rows = flat_motion(robot, {0.3, 0.2}, {0.9, -0.9}, 5).samples;
  order.stops = stop_motions(robot, {order.rows, {}}, {});
  std::vector<double> latency;
  for (std::size_t i = 0; i < std::clamp<std::size_t>(options.requests / 20, 1, 10); ++i) {
    const auto executor = start({"executor", "--start", "0.3,0.2", "--state", log.string() + ".state"}, log);
    Publisher publisher;
    publisher.wait_until([](const ExecutorState& s) { return s.mode == ExecutorMode::kResting; }, *executor);
    const auto published = Clock::now();
    publisher.publish(order);
    publisher.wait_until([](const ExecutorState& s) { return s.mode == ExecutorMode::kExecuting; }, *executor);
    latency.push_back(1e3 * seconds_since(published));
  }
  report.distribution("publication to start of a 5 s motion", latency, "ms", 50);
}

int run(const Options& options) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("fjr_service_bench_{}", ::getpid());
  fs::create_directories(folder);
  Report report;
  overhead(report, options, folder / "overhead.log");
  for (const int workers : {1, 2}) throughput(report, options, workers, folder / "throughput.log");
  cancelling(report, options, folder / "cancel.log");
  memory(report, folder / "memory.log");
  ticks(report, options, folder / "executor.log");
  starts(report, options, folder / "starts.log");
  if (!options.json.empty()) report.write(options.json);
  fs::remove_all(folder);
  return 0;
}

}  // namespace
}  // namespace fjr

int main(int argc, char** argv) {
  fjr::Options options;
  CLI::App app("What the planning service costs beyond planning");
  app.add_option("--requests", options.requests, "Requests for latencies; the other counts follow")
      ->check(CLI::PositiveNumber);
  app.add_option("--seconds", options.seconds, "How long the executor's ticks are watched")->check(CLI::PositiveNumber);
  app.add_option("--json", options.json, "Also write the figures there")->type_name("FILE");
  CLI11_PARSE(app, argc, argv);
  try {
    return fjr::run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "service_bench: {}\n", error.what());
    return 1;
  }
}
