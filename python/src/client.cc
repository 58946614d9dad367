#include "planner/client/client.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "common/bounded_json.h"
#include "common/input_error.h"
#include "planner/client/halt.h"
#include "planner/results/report/plan_files.h"
#include "python/src/parts.h"
#include "python/src/planned.h"
#include "python/src/supervised.h"

namespace fjr::python {
namespace {

namespace nb = nanobind;
namespace fs = std::filesystem;

struct Connection {
  unsigned domain;
  std::optional<fs::path> security;  // none: what FJR_SECURITY names
  bool allow_insecure_network;
  double find, silence;  // [s]
};

// What a service and an executor have answered.
struct Answered {
  std::string id;
  Reply reply;
  std::optional<ExecutionResult> result;
};

using Told = std::variant<ProgressReport, ExecutionProgress>;

Network network_of(const Connection& connection) {
  Network network;
  network.domain = connection.domain;
  if (connection.security) network.security = *connection.security;
  network.allow_insecure_network = connection.allow_insecure_network;
  return network;
}

Answered ask(const Connection& connection, Order order, const nb::object& listener) {
  order.id = new_client();
  return supervised<Told>(listener, [&](Wire<Told>& wire) {
    ClientOptions options;
    options.network = network_of(connection);
    options.find = connection.find;
    options.silence = connection.silence;
    options.on_progress = [&wire](const ProgressReport& report) { wire.tell(report); };
    options.on_execution = [&wire](const ExecutionProgress& progress) { wire.tell(progress); };
    options.cancelled = [&wire] { return wire.cancelled(); };
    options.stop_execution = [&options](const std::string& robot_id) {
      (void)halt(ExecutorCommand::kHold, {.network = options.network, .robot_id = robot_id});
    };
    Answer answer = request_plan(order, options);
    return Answered{to_text(order.id), std::move(answer.reply), std::move(answer.result)};
  });
}

std::optional<Planned> plan_in(const Answered& answered) {
  const Reply& reply = answered.reply;
  if (reply.plan_json.empty()) return std::nullopt;
  auto json = json_from_text<nlohmann::ordered_json>(reply.plan_json);
  std::optional<Trajectory> trajectory;
  if (!reply.rows.empty()) {
    trajectory = Trajectory{reply.rows, {}};
    describe(*trajectory, json);
  }
  return Planned{record_of(std::move(json), "the service's plan", std::move(trajectory)), nullptr};
}

nb::dict status_of_service(const ServiceStatus& s) {
  nb::dict status;
  status["instance"] = s.instance;
  status["robot_id"] = s.robot_id;
  status["robot_hash"] = s.robot_hash;
  status["version"] = s.version;
  status["answers"] = s.epoch != 0;
  status["uptime"] = s.uptime;
  status["queued"] = s.queued;
  status["workers"] = s.workers;
  status["solving"] = s.solving;
  status["solved"] = s.solved;
  return status;
}

nb::dict status_of_executor(const ExecutorState& s) {
  nb::dict status;
  status["robot_id"] = s.robot_id;
  status["robot_hash"] = s.robot_hash;
  status["mode"] = name(s.mode);
  status["time"] = s.time;
  status["q"] = s.q;
  status["theta"] = s.theta;
  status["dq"] = s.dq;
  status["dtheta"] = s.dtheta;
  status["tau"] = s.torque;
  return status;
}

nb::tuple look_around(const Connection& connection, double wait) {
  Overview seen;
  {
    const nb::gil_scoped_release others_may_run;
    seen = overview(network_of(connection), wait);
  }
  nb::list services, executors;
  for (const ServiceStatus& service : seen.services) services.append(status_of_service(service));
  for (const ExecutorState& executor : seen.executors) executors.append(status_of_executor(executor));
  return nb::make_tuple(services, executors, seen.strangers);
}

nb::tuple pair(const Joints<double>& values) { return nb::make_tuple(values[0], values[1]); }

nb::dict result_of(const ExecutionResult& r) {
  nb::dict result;
  result["code"] = static_cast<int>(r.code);
  result["name"] = name(r.code);
  result["sentence"] = r.sentence;
  result["link_error"] = pair(r.link_error);
  result["link_error_rms"] = pair(r.link_error_rms);
  result["final_link_error"] = pair(r.final_link_error);
  result["residual_vibration"] = pair(r.residual_vibration);
  result["feedback_torque"] = pair(r.feedback_torque);
  result["log_file"] = r.log_file;
  return result;
}

}  // namespace

void add_client(nb::module_& module) {
  nb::class_<ProgressReport>(module, "ServiceProgress", "Where a request is with the service.")
      .def_ro("queue_position", &ProgressReport::queue_position)
      .def_ro("progress", &ProgressReport::progress)
      .def_ro("elapsed", &ProgressReport::elapsed);
  nb::class_<ExecutionProgress>(module, "ExecutionProgress", "Where the arm is within a trajectory.")
      .def_ro("time", &ExecutionProgress::time)
      .def_ro("duration", &ExecutionProgress::duration)
      .def_ro("link_error", &ExecutionProgress::error);
  nb::class_<Answered>(module, "Answered")
      .def_ro("id", &Answered::id)
      .def_prop_ro("plan", plan_in)
      .def_prop_ro("state", [](const Answered& a) { return name(a.reply.state); })
      .def_prop_ro("bad_input", [](const Answered& a) { return a.reply.why.reason == Reason::kBadInput; })
      .def_prop_ro("field", [](const Answered& a) { return a.reply.why.field; })
      .def_prop_ro("sentence", [](const Answered& a) { return a.reply.why.sentence; })
      .def_prop_ro("solve_time", [](const Answered& a) { return a.reply.solve_time; })
      .def_prop_ro("wait_time", [](const Answered& a) { return a.reply.wait_time; })
      .def_prop_ro("result", [](const Answered& a) {
        return a.result ? std::optional<nb::dict>(result_of(*a.result)) : std::nullopt;
      });
  nb::class_<Connection>(module, "Connection")
      .def(nb::init<unsigned, std::optional<fs::path>, bool, double, double>(), nb::arg("domain"),
           nb::arg("security").none(), nb::arg("allow_insecure_network"), nb::arg("find"), nb::arg("silence"))
      .def(
          "request",
          [](const Connection& connection, std::string name, std::string document, bool execute, std::string robot_id,
             std::string robot_hash, int priority, double budget, const nb::object& listener) {
            Order order;
            order.name = std::move(name);
            order.action = execute ? Action::kPlanAndExecute : Action::kPlan;
            order.document = std::move(document);
            order.robot_id = std::move(robot_id);
            order.robot_hash = std::move(robot_hash);
            order.priority = priority;
            order.budget = budget;
            return ask(connection, std::move(order), listener);
          },
          nb::arg("name"), nb::arg("document"), nb::arg("execute"), nb::arg("robot_id"), nb::arg("robot_hash"),
          nb::arg("priority"), nb::arg("budget"), nb::arg("listener"))
      .def(
          "execute",
          [](const Connection& connection, const std::string& id, bool repeat, std::string robot_id,
             const nb::object& listener) {
            const auto trajectory = request_id_from(id);
            if (!trajectory) throw InputError("trajectory", "id", "is not 32 hexadecimal digits, a minus and a number");
            Order order;
            order.name = "trajectory";
            order.action = repeat ? Action::kRepeat : Action::kExecute;
            order.trajectory_id = *trajectory;
            order.robot_id = std::move(robot_id);
            return ask(connection, std::move(order), listener);
          },
          nb::arg("id"), nb::arg("repeat"), nb::arg("robot_id"), nb::arg("listener"))
      .def("overview", look_around, nb::arg("wait"));
}

}  // namespace fjr::python
