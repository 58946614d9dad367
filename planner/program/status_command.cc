// fjr status: how the planning services and executors are doing.
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/say.h"
#include "planner/client/client.h"
#include "planner/program/commands.h"
#include "planner/program/interrupt.h"
#include "planner/program/number_checks.h"
#include "planner/results/plan_json.h"

namespace fjr {
namespace {

struct StatusArguments {
  unsigned domain = 0;
  double wait = 1;
  bool json = false;
  bool watch = false;
};

std::string text_for_people(const ServiceStatus& s) {
  std::string text = fmt::format("{}: up {:.0f} s, fjr {}, {}\n", s.instance, s.uptime, s.version,
                                 s.epoch > 0 ? fmt::format("owner, epoch {}", s.epoch) : "standby");
  text += fmt::format("  robot       {}, {}\n", s.robot_id, s.robot_hash.substr(0, 12));
  text += fmt::format("  queue       {} waiting, at most {} of one client\n", s.queued, s.queue_capacity);
  text +=
      fmt::format("  workers     {} of {} solving, {} lost since the start\n", s.solving, s.workers, s.workers_lost);
  text += fmt::format(
      "  requests    {} received, {} repeated; {} solved, {} rejected, {} infeasible, {} failed, {} cancelled, {} "
      "expired\n",
      s.received, s.duplicates, s.solved, s.rejected, s.infeasible, s.failed, s.cancelled, s.expired);
  text += fmt::format("  latency     p50 {:.3f} s, p90 {:.3f} s, p99 {:.3f} s of the last solved ones\n", s.latency_p50,
                      s.latency_p90, s.latency_p99);
  text += fmt::format("  memory      {:.1f} MB, workers included\n", static_cast<double>(s.memory) / 1e6);
  return text;
}

nlohmann::ordered_json json_of(const ServiceStatus& s) {
  return {{"instance", s.instance},
          {"version", s.version},
          {"robot_id", s.robot_id},
          {"robot_hash", s.robot_hash},
          {"owner", s.epoch > 0},
          {"epoch", s.epoch},
          {"uptime", s.uptime},
          {"queue", {{"waiting", s.queued}, {"capacity", s.queue_capacity}}},
          {"workers", {{"all", s.workers}, {"solving", s.solving}, {"lost", s.workers_lost}}},
          {"requests",
           {{"received", s.received},
            {"repeated", s.duplicates},
            {"solved", s.solved},
            {"rejected", s.rejected},
            {"infeasible", s.infeasible},
            {"failed", s.failed},
            {"cancelled", s.cancelled},
            {"expired", s.expired}}},
          {"latency", {{"p50", s.latency_p50}, {"p90", s.latency_p90}, {"p99", s.latency_p99}}},
          {"memory_bytes", s.memory}};
}

std::string text_for_people(const ExecutorState& s) {
  std::string text = fmt::format("executor of {}: {}, largest epoch {}\n", s.robot_id, name(s.mode), s.epoch);
  text += fmt::format("  robot       {}\n", s.robot_hash.substr(0, 12));
  if (s.trajectory_id != RequestId{}) {
    text += fmt::format("  trajectory  {}, {:.3f} s\n", to_text(s.trajectory_id), s.time);
  }
  text += fmt::format("  links       at {:.5f} and {:.5f} rad, planned {:.5f} and {:.5f} rad\n", s.q[0], s.q[1],
                      s.planned_q[0], s.planned_q[1]);
  text += fmt::format("  motors      at {:.5f} and {:.5f} rad, {:.3f} and {:.3f} N m, feedback {:.3f} and {:.3f} N m\n",
                      s.theta[0], s.theta[1], s.torque[0], s.torque[1], s.feedback[0], s.feedback[1]);
  return text;
}

nlohmann::ordered_json json_of(const ExecutorState& s) {
  return {{"robot_id", s.robot_id},   {"robot_hash", s.robot_hash},
          {"mode", name(s.mode)},     {"trajectory_id", s.trajectory_id == RequestId{} ? "" : to_text(s.trajectory_id)},
          {"epoch", s.epoch},         {"stamp_ns", s.stamp},
          {"time", s.time},           {"q", s.q},
          {"planned_q", s.planned_q}, {"theta", s.theta},
          {"torque", s.torque},       {"feedback", s.feedback}};
}

std::string text_for_people(const ArmDrift& d) { return fmt::format("arm of {}: {}\n", d.robot_id, sentence_of(d)); }

nlohmann::ordered_json json_of(const ArmDrift& d) {
  return {{"robot_id", d.robot_id},    {"robot_hash", d.robot_hash},
          {"motions", d.motions},      {"drifts", d.drifts},
          {"evidence", d.evidence},    {"alarm", d.alarm},
          {"parameter", d.parameter},  {"unit", d.unit},
          {"share", d.share},          {"known", d.known},
          {"change", d.change},        {"change_error", d.change_error},
          {"since", to_text(d.since)}, {"motions_since", d.motions_since}};
}

template <class List>
nlohmann::ordered_json show(const List& list, bool json) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const auto& one : list) {
    if (!json) fmt::print("{}", text_for_people(one));
    all.push_back(json_of(one));
  }
  return all;
}

nlohmann::ordered_json show(const Overview& found, bool json) {
  nlohmann::ordered_json all;
  all["services"] = show(found.services, json);
  all["executors"] = show(found.executors, json);
  all["arms"] = show(found.drifts, json);
  return all;
}

// Services and executors that were heard before and have become silent.
class Missing {
 public:
  using Clock = std::chrono::steady_clock;

  // Their names, and for how long they have been silent [s].
  std::vector<std::pair<std::string, double>> after(const Overview& found) {
    const auto now = Clock::now();
    for (const ServiceStatus& service : found.services) heard_[service.instance] = now;
    for (const ExecutorState& executor : found.executors) heard_["executor of " + executor.robot_id] = now;
    std::vector<std::pair<std::string, double>> missing;
    for (const auto& [name, last] : heard_) {
      if (last != now) missing.emplace_back(name, std::chrono::duration<double>(now - last).count());
    }
    return missing;
  }

 private:
  std::map<std::string, Clock::time_point> heard_;
};

// Shows the present state. On a terminal it replaces the one before; elsewhere they follow each other, with --json one
// per line.
void show_again(const Overview& found, Missing& missing, bool json) {
  const auto silent = missing.after(found);
  if (json) {
    nlohmann::ordered_json all = show(found, true);
    all["silent"] = nlohmann::ordered_json::array();
    for (const auto& [name, seconds] : silent) all["silent"].push_back({{"name", name}, {"seconds", seconds}});
    fmt::print("{}\n", all.dump());
  } else {
    const bool terminal = ::isatty(STDOUT_FILENO) != 0;
    const std::string time = fmt::format("{:%Y-%m-%d %H:%M:%S}", fmt::localtime(std::time(nullptr)));
    fmt::print("{}{}\n", terminal ? "\033[H\033[2J" : "", time);
    (void)show(found, false);
    for (const auto& [name, seconds] : silent) fmt::print("{}: silent for {:.0f} s\n", name, seconds);
    if (found.services.empty()) fmt::print("no planning service is heard\n");
    if (!terminal) fmt::print("\n");
  }
  std::fflush(stdout);
}

// Shows the state again and again until Ctrl-C.
int watch(const StatusArguments& options) {
  catch_interrupts();
  Lookout lookout({.domain = options.domain});
  Missing missing;
  for (;;) {
    const Overview found = lookout.look(options.wait, interrupted);
    if (interrupted()) return 0;
    show_again(found, missing, options.json);
  }
}

int run(const StatusArguments& options) {
  if (options.watch) return watch(options);
  const Overview found = overview({.domain = options.domain}, options.wait);
  const nlohmann::ordered_json all = show(found, options.json);
  if (options.json) fmt::print("{}", json_text(all));
  if (!found.services.empty()) return 0;
  say("fjr: no planning service on DDS domain {} (looked for {:.3g} s){}\n", options.domain, found.looked,
      found.strangers ? ": " + *found.strangers : "");
  return 1;
}

}  // namespace

void add_status(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<StatusArguments>();
  CLI::App* command = app.add_subcommand("status", "Show how the planning services and executors on DDS are doing");
  command->add_option("--domain", options->domain, "DDS domain")->check(CLI::Range(0, 230));
  command->add_option("--wait", options->wait, "How long to listen, in seconds")
      ->check(positive())
      ->capture_default_str();
  command->add_flag("--watch", options->watch,
                    "Again and again until Ctrl-C, every --wait seconds, and who is silent; with --json one a line");
  command->add_flag("--json", options->json, "Only JSON on stdout: {services: [...], executors: [...], arms: [...]}");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace fjr
