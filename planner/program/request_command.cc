// fjr request: have a request planned by the service.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "common/atomic_file.h"
#include "common/bounded_json.h"
#include "common/input_error.h"
#include "common/say.h"
#include "common/strict_yaml.h"
#include "planner/client/client.h"
#include "planner/client/halt.h"
#include "planner/program/commands.h"
#include "planner/program/interrupt.h"
#include "planner/program/network_arguments.h"
#include "planner/program/number_checks.h"
#include "planner/program/progress_line.h"
#include "planner/program/request_file.h"
#include "planner/program/result_files.h"
#include "planner/program/trajectory_id.h"
#include "planner/results/plan_json.h"
#include "planner/results/report/plan_files.h"
#include "planner/results/result_folder.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

struct RequestArguments {
  std::string request;  // a file, or the folder of an earlier request
  std::string out;
  std::string robot_id;
  bool json = false;
  bool execute = false;
  bool repeat = false;
  double budget = 0;
  int priority = 0;
  Talk talk = Talk::kUsual;
  NetworkArguments network;
  ClientOptions client;
};

// Returns the hash of the robot that a request names, because a service for another robot must refuse the request.
std::string hash_of_named_robot(const Order& order, const fs::path& folder) {
  const auto robot = YamlNode::parse(order.document, order.name).find("robot");
  return robot ? robot_hash(load_parameters(folder / robot->text())) : "";
}

Order order_of(const RequestArguments& options) {
  Order order;
  order.id = new_client();
  order.priority = options.priority;
  order.budget = options.budget;
  order.robot_id = options.robot_id;
  return order;
}

// Loads an order for an earlier plan, which is executed as it is or corrected by its last run.
Order load_earlier(const RequestArguments& options) {
  if (!options.execute && !options.repeat) {
    throw InputError(options.request, "",
                     "is a folder; --execute has its trajectory executed, --repeat corrects it by its last run first, "
                     "planning needs a file");
  }
  if (options.execute && !options.out.empty()) {
    throw InputError("--out", "", "goes with a request file or --repeat; the folder has its files already");
  }
  Order order = order_of(options);
  order.name = fs::path(options.request).lexically_normal().filename().string();
  order.action = options.repeat ? Action::kRepeat : Action::kExecute;
  const FolderLock lock(options.request);
  order.trajectory_id = read_trajectory_id(options.request);
  return order;
}

Order load_order(const RequestArguments& options) {
  std::error_code error;
  if (fs::is_directory(options.request, error)) return load_earlier(options);
  if (options.repeat) {
    throw InputError(options.request, "",
                     "--repeat goes with the folder of an earlier request, whose motion it repeats");
  }
  const RequestFile file = read_request_file(options.request);
  (void)YamlNode::parse(file.text, file.source);  // refuses what is not a document, or far too large
  Order order = order_of(options);
  order.name = fs::path(file.source).filename().string();
  order.action = options.execute ? Action::kPlanAndExecute : Action::kPlan;
  order.document = file.text;
  order.robot_hash = hash_of_named_robot(order, file.folder);
  return order;
}

// Returns whether the reply says nothing about the request: a refusal of the moment, or processes that died.
bool has_failed(const Reply& reply) {
  switch (reply.why.reason) {
    case Reason::kQueueFull:
    case Reason::kArmNotAtRest:
    case Reason::kNoTrajectory:
    case Reason::kWorkerLost:
      return true;
    default:
      return false;
  }
}

const char* status_name(const Reply& reply) { return has_failed(reply) ? "failed" : name(status_of(reply)); }
int exit_code_of(const Reply& reply) { return has_failed(reply) ? 1 : exit_code(status_of(reply)); }

std::string reason_of(const Reply& reply) {
  return reply.why.field.empty() ? reply.why.sentence : reply.why.field + ": " + reply.why.sentence;
}

// Returns the result of the execution on the arm, which is added to plan.json.
nlohmann::ordered_json json_of(const ExecutionResult& r) {
  const bool done = r.code == ResultCode::kSuccessful;
  nlohmann::ordered_json json{{"result", name(r.code)},
                              {"reason", done ? nlohmann::ordered_json() : nlohmann::ordered_json(r.sentence)},
                              {"trajectory_id", to_text(r.trajectory_id)}};
  if (!has_moved(r.code)) return json;
  json["link_error_rad"] = r.link_error;
  json["link_error_rms_rad"] = r.link_error_rms;
  json["final_link_error_rad"] = r.final_link_error;
  json["residual_vibration_rad"] = r.residual_vibration;
  json["max_feedback_torque"] = r.feedback_torque;
  json["limits"] = nlohmann::ordered_json::array();
  for (const LimitMargin& limit : r.limits) {
    json["limits"].push_back(
        {{"name", limit.name}, {"joint", limit.joint}, {"limit", limit.limit}, {"reached", limit.reached}});
  }
  json["log"] = r.log_file.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(r.log_file);
  return json;
}

std::string json_of(const Order& order, const Reply& reply) {
  if (!reply.plan_json.empty()) return reply.plan_json;
  auto json = bad_input_json(fs::path(order.name).stem().string(), reason_of(reply), reply.why.field);
  json["status"] = status_name(reply);
  return json_text(json);
}

// silence: why the result of the execution did not come; empty if it did, or if none was asked for.
std::string json_of(const Order& order, const Answer& answer, const std::string& silence) {
  const std::string plan = json_of(order, answer.reply);
  if (!answer.result && silence.empty()) return plan;
  auto json = json_from_text<nlohmann::ordered_json>(plan);  // whoever answered
  if (!json.is_object()) return plan;
  json["execution"] =
      answer.result
          ? json_of(*answer.result)
          : nlohmann::ordered_json{{"result", nullptr}, {"reason", silence}, {"trajectory_id", to_text(order.id)}};
  return json_text(json);
}

struct Stored {
  bool files = false;           // they are in the folder
  std::string about_previous;   // a sentence on earlier results, where there are any
  std::exception_ptr obstacle;  // why they could not be stored
};

Stored store_in(const fs::path& folder, const Order& order, const Reply& reply) {
  const PlanStatus status = status_of(reply);
  if (status == PlanStatus::kBadInput || has_failed(reply)) {
    const FolderLock lock(folder);
    if (value_of_results(folder) != ResultValue::kNothing) return {};  // a refusal is nothing to make room for
  }
  NewResults results(folder);
  if (!reply.rows.empty()) {
    Trajectory trajectory{reply.rows, {}};
    describe(trajectory, json_from_text<nlohmann::ordered_json>(reply.plan_json));
    write_csv(trajectory, results.stage() / "trajectory.csv");
    write_trajectory_id(order.id, results.stage());
  }
  write_file(results.stage() / "plan.json", json_of(order, reply));
  const bool kept = results.publish();
  return {true, about_previous(folder, status, kept), nullptr};
}

// What became of the request, and of the arm, is told also where the files cannot be written.
Stored store(const RequestArguments& options, const Order& order, const Reply& reply) {
  if (options.out.empty()) return {};
  try {
    return store_in(options.out, order, reply);
  } catch (...) {
    return {false, "", std::current_exception()};
  }
}

// Returns what was learnt for a repetition. wanted: a repetition was requested, so a motion as it was planned is
// reported too.
std::string about_repetition(const Reply& reply, bool wanted) {
  if (reply.plan_json.empty()) return "";
  const auto plan = json_from_text<nlohmann::json>(reply.plan_json);  // whoever answered
  const auto found = plan.find("repetition");
  if (found == plan.end() || !found->is_object()) {
    if (!wanted) return "";
    return "  repetition  1, as it was planned: no run of it is known that it could be corrected by\n";
  }
  const double fraction = found->at("fraction");
  std::string text = fmt::format("  repetition  {}, with {} of the correction", found->at("number").get<int>(),
                                 fraction == 0 ? "none" : fmt::format("{:g}", fraction));
  if (const auto& rms = found->at("last_link_error_rms_rad"); !rms.is_null()) {
    text += fmt::format(" after a run {:.3g} and {:.3g} rad rms off the plan", rms.at(0).get<double>(),
                        rms.at(1).get<double>());
  }
  text += "\n";
  for (const auto& reason : found->at("reasons")) {
    text += fmt::format("  held back   {}\n", reason.get<std::string>());
  }
  return text;
}

std::string summary(const RequestArguments& options, const Reply& reply, double elapsed, bool has_files) {
  std::string text = fmt::format("{}: {}\n", source_of(options.request).stem().string(), status_name(reply));
  if (!reply.rows.empty()) {
    text += fmt::format("  duration    {:.6g} s, {} rows\n", reply.rows.back().time, reply.rows.size());
  }
  text += about_repetition(reply, options.repeat);
  if (reply.solve_time > 0) {
    text += fmt::format("  service     solved in {:.3f} s after {:.3f} s in the queue; {:.3f} s in all\n",
                        reply.solve_time, reply.wait_time, elapsed);
  }
  if (has_files) {
    text += fmt::format("  files       {}{}\n",
                        reply.rows.empty() ? "" : fmt::format("{0}/trajectory.csv, {0}/trajectory.id, ", options.out),
                        (fs::path(options.out) / "plan.json").string());
  }
  return text;
}

std::string summary(const ExecutionResult& r) {
  std::string text = fmt::format("  execution   code {} {}, trajectory {}\n", static_cast<int>(r.code), name(r.code),
                                 to_text(r.trajectory_id));
  if (!has_moved(r.code)) return text;
  const auto line = [&](const char* what, const Joints<double>& pair, const char* unit) {
    text += fmt::format("    {:<22}{:.3g} and {:.3g} {}\n", what, pair[0], pair[1], unit);
  };
  line("link error", r.link_error, "rad at most");
  line("", r.link_error_rms, "rad rms");
  line("", r.final_link_error, "rad at the end");
  line("residual vibration", r.residual_vibration, "rad");
  line("feedback", r.feedback_torque, "N m at most");
  for (const LimitMargin& limit : r.limits) {
    text += fmt::format("    {:<22}{:.6g} of {:.6g}\n", fmt::format("{} {}", limit.name, limit.joint), limit.reached,
                        limit.limit);
  }
  if (!r.log_file.empty()) text += fmt::format("    {:<22}{}\n", "log", r.log_file);
  return text;
}

Answer ask(const RequestArguments& options, const Order& order) {
  ProgressLine line(fs::path(order.name).stem().string(), options.talk);
  ClientOptions client = options.client;
  options.network.apply_to(client.network);
  client.on_progress = [&line](const ProgressReport& report) { line.show(report.progress); };
  client.on_execution = [&line](const ExecutionProgress& p) {
    line.show(fmt::format("executing, {:.2f} of {:.2f} s, links {:.1e} and {:.1e} rad off", p.time, p.duration,
                          p.error[0], p.error[1]));
  };
  client.cancelled = interrupted;
  client.stop_execution = [&](const std::string& robot_id) {
    line.show("bringing the arm to rest");
    (void)halt(ExecutorCommand::kHold, {.network = client.network, .robot_id = robot_id});
  };
  return request_plan(order, client);
}

// Tells the answer, and what was before in the folder. silence: as in json_of(). Returns the exit code.
int tell(const RequestArguments& options, const Order& order, const Answer& answer, double elapsed,
         const Stored& stored, const std::string& silence) {
  const Reply& reply = answer.reply;
  if (reply.state != ReplyState::kSolved) {
    say("fjr: {}: {}: {}\n", options.request, name(reply.state), reason_of(reply));
  }
  fmt::print("{}", options.json ? json_of(order, answer, silence) : summary(options, reply, elapsed, stored.files));
  if (!stored.about_previous.empty()) say("fjr: {}\n", stored.about_previous);
  if (!silence.empty()) {
    say("fjr: {}\n", silence);
    return 1;
  }
  if (!answer.result) return exit_code_of(reply);
  if (!options.json) fmt::print("{}", summary(*answer.result));
  if (answer.result->code == ResultCode::kSuccessful) return 0;
  say("fjr: {}: not executed to its end: {}\n", options.request, answer.result->sentence);
  return 1;
}

int run(const RequestArguments& options) {
  catch_interrupts();
  const Order order = load_order(options);
  if (!options.out.empty()) prepare_folder(options.out);
  const auto began = std::chrono::steady_clock::now();
  Answer answer;
  std::string silence;  // why the result of the execution did not come; the plan is there all the same
  try {
    answer = ask(options, order);
  } catch (const NoExecutionResult& error) {
    answer.reply = error.reply;
    silence = error.what();
  }
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  const Stored stored = store(options, order, answer.reply);
  const int code = tell(options, order, answer, elapsed, stored, silence);
  if (stored.obstacle) std::rethrow_exception(stored.obstacle);
  return code;
}

}  // namespace

void add_request(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<RequestArguments>();
  CLI::App* command = app.add_subcommand("request", "Have a request planned by the service and store the results");
  command
      ->add_option("request", options->request,
                   "Request file, or - for standard input; with --execute also the folder of an earlier request, whose "
                   "trajectory is then executed as it was planned; with --repeat that folder")
      ->required()
      ->type_name("REQUEST.yaml|-|DIR");
  command->add_option("--out", options->out, "Folder of the results")->type_name("DIR");
  command->add_flag("--execute", options->execute, "Have it executed, and wait for the result");
  command
      ->add_flag(
          "--repeat", options->repeat,
          "Have the motion executed once more, corrected by what its last run was off the plan, and wait for the "
          "result")
      ->excludes("--execute");
  command->add_flag("--json", options->json, "Only JSON on stdout: plan.json, and with --execute what became of it");
  command->add_option("--budget", options->budget, "Time the service may take, in seconds")
      ->check(positive())
      ->type_name("S");
  command->add_option("--priority", options->priority, "Larger goes first")->type_name("N");
  command->add_option("--robot-id", options->robot_id, "Which arm; needed only where several are served")
      ->type_name("NAME");
  add_talk(*command, options->talk);
  add_network_options(*command, options->network);
  command->add_option("--find", options->client.find, "How long to look for a service, in seconds")
      ->check(positive())
      ->capture_default_str();
  command->add_option("--silence", options->client.silence, "Silence after which no answer is expected, in seconds")
      ->check(positive())
      ->capture_default_str();
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace fjr
