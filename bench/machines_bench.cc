// A service on several machines: network namespaces on this one, so it takes root. Whether every request is answered
// once, and how many a second, while machines, cables and networks fail.
//   build/bench/machines_bench [--requests N] [--seconds S] [--slots N] [--only SCENARIO]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/service/fleet.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::size_t requests = 1000;
  double seconds = 0.5;  // that a request takes, of waiting; 0: it is planned
  int slots = 20;        // of each worker
  std::string only;
};

// Twenty motions of about 0.1 s of planning.
std::string motion(std::size_t number) {
  const double at = 0.005 * static_cast<double>(number % 20);
  return fmt::format("start: {{q: [0.3, 0.2]}}\ngoal: {{q: [{:.3f}, {:.3f}]}}\nobjective: fastest\n", 0.42 + at,
                     0.08 - at);
}

struct Scenario {
  std::string name;
  bool standby = false;
  int loss = 0;  // packets of a thousand
  std::function<void(Fleet::Member& owner, Fleet::Member& worker, double since)>
      event;  // since: [s] a third was answered
};

std::vector<Scenario> scenarios() {
  const auto once = [](auto act) {
    return [act, done = false](Fleet::Member& owner, Fleet::Member& worker, double) mutable {
      if (!done) act(owner, worker);
      done = true;
    };
  };
  const auto cut = [state = 0](Fleet::Member&, Fleet::Member& worker, double since) mutable {
    if (state == 0) worker.machine->cut();
    if (state <= 1) state = 1;
    if (state == 1 && since > 10) {
      worker.machine->mend();
      state = 2;
    }
  };
  return {{"nothing fails", false, 0, {}},
          {"kill -9 of a worker", false, 0, once([](auto&, auto& worker) { worker.process->send(SIGKILL); })},
          {"kill -9 of the owner", true, 0, once([](auto& owner, auto&) { owner.process->send(SIGKILL); })},
          {"a cable cut for 10 s", false, 0, cut},
          {"5 % of packets lost", false, 50, {}}};
}

// What a service by itself answers to each motion: rows and all.
std::vector<Reply> planned_by_one(const fs::path& folder, const Options& options) {
  if (options.seconds > 0) return {};
  Fleet alone(folder, 0);
  alone.serve("alone", 2);
  if (!alone.has_slots(2)) throw std::runtime_error("no service");
  std::vector<std::string> documents;
  for (std::size_t i = 0; i < 20; ++i) documents.push_back(motion(i));
  std::vector<Reply> replies;
  for (auto& one : alone.ask(documents, 0, 300).asked) replies.push_back(std::move(one.reply));
  return replies;
}

bool same_rows(const Reply& a, const Reply& b) {
  return a.rows.size() == b.rows.size() &&
         std::memcmp(a.rows.data(), b.rows.data(), a.rows.size() * sizeof(Sample)) == 0;
}

void run(Scenario& scenario, const fs::path& folder, const Options& options, const std::vector<Reply>& expected) {
  Fleet fleet(folder, options.seconds);
  if (!fleet.possible()) throw std::runtime_error("only root can have network namespaces");
  Fleet::Member& owner = fleet.serve("owner", 0);
  Fleet::Member& worker = fleet.work("first", options.slots);
  Fleet::Member& second = fleet.work("second", options.slots);
  const auto all = static_cast<std::uint32_t>(2 * options.slots);
  if (!fleet.has_slots(all)) throw std::runtime_error("the workers are not there");
  if (scenario.standby) fleet.serve("standby", 0);
  if (scenario.standby) std::this_thread::sleep_for(std::chrono::seconds(2));
  if (scenario.loss > 0) {
    for (const auto* member : {&owner, &worker, &second}) member->machine->lose(scenario.loss);
  }
  std::vector<std::string> documents;
  for (std::size_t i = 0; i < options.requests; ++i) documents.push_back(motion(i));
  // Twice what one machine can do.
  const double rate = options.seconds > 0 ? 2 * options.slots / options.seconds : 0;
  double third = -1;
  const auto began = Fleet::Clock::now();
  const Fleet::Outcome outcome = fleet.ask(documents, rate, 600, [&](std::size_t answers) {
    const double now = std::chrono::duration<double>(Fleet::Clock::now() - began).count();
    if (third < 0 && answers >= options.requests / 3) third = now;
    if (third >= 0 && scenario.event) scenario.event(owner, worker, now - third);
  });
  std::size_t other_bytes = 0;
  std::vector<double> latencies;
  for (std::size_t i = 0; i < outcome.asked.size(); ++i) {
    const auto& one = outcome.asked[i];
    latencies.push_back(one.answered - one.asked);
    if (!expected.empty() && !same_rows(one.reply, expected[i % expected.size()])) ++other_bytes;
  }
  std::sort(latencies.begin(), latencies.end());
  const double throughput = static_cast<double>(outcome.answered) / outcome.seconds;
  fmt::print(
      "{:<22}{:>6} of {} answered, {} otherwise a second time{}; {:.1f} a second{}; latency {:.2f} s, p99 {:.2f} s\n",
      scenario.name, outcome.answered, options.requests, outcome.different,
      expected.empty() ? "" : fmt::format(", {} with other rows than by one machine", other_bytes), throughput,
      rate > 0 ? fmt::format(" of {:.1f} ({:.0f} %)", rate, 100 * throughput / rate) : "",
      latencies[latencies.size() / 2], latencies[latencies.size() * 99 / 100]);
  std::fflush(stdout);
}

int run_all(const Options& options) {
  const fs::path folder = fs::temp_directory_path() / ("fjr_machines_bench_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const std::vector<Reply> expected = planned_by_one(folder, options);
  for (Scenario& scenario : scenarios()) {
    if (options.only.empty() || scenario.name.find(options.only) != std::string::npos) {
      run(scenario, folder, options, expected);
    }
  }
  fs::remove_all(folder);
  return 0;
}

}  // namespace
}  // namespace fjr

int main(int argc, char** argv) {
  fjr::Options options;
  CLI::App app("A service on several machines, which fail");
  app.add_option("--requests", options.requests, "How many are asked for")->capture_default_str();
  app.add_option("--seconds", options.seconds, "That each takes, of waiting; 0: it is planned")->capture_default_str();
  app.add_option("--slots", options.slots, "Of each of the two workers")->capture_default_str();
  app.add_option("--only", options.only, "The scenarios with this in their names");
  CLI11_PARSE(app, argc, argv);
  try {
    return fjr::run_all(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "machines_bench: {}\n", error.what());
    return 1;
  }
}
