#include "planner/plan.h"

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/input_error.h"
#include "common/strict_yaml.h"
#include "planner/certificate/simulation.h"
#include "planner/nlp/linear_solver.h"
#include "planner/request/keys.h"
#include "planner/request/request.h"
#include "planner/request/request_keys.h"
#include "planner/results/plan_json.h"
#include "planner/results/report/plan_files.h"
#include "planner/results/report/plan_page.h"
#include "planner/results/result_folder.h"
#include "planner/results/solution_file.h"
#include "planner/results/verification.h"
#include "python/src/arrays.h"
#include "python/src/parts.h"
#include "python/src/planned.h"
#include "python/src/robot.h"
#include "python/src/supervised.h"

namespace fjr::python {
namespace {

namespace nb = nanobind;
namespace fs = std::filesystem;

// A request, as text or in a file, and whose it is.
struct Asked {
  std::optional<std::string> text;  // none: in the file `source`
  std::string source;               // for messages and for the plan's name
  fs::path folder;                  // what a relative `robot` is relative to
  const Robot* robot;               // null: the one it names, or else the shipped one
};

void check_solver(const std::string& name) {
  const std::vector<std::string>& all = linear_solvers();
  const std::string fault = std::find(all.begin(), all.end(), name) == all.end()
                                ? fmt::format("{} is none of {}", shown(name), fmt::join(all, ", "))
                                : what_is_missing(name);
  if (!fault.empty()) throw InputError("linear_solver", "", fault);
}

Problem problem_of(const Asked& asked) {
  const YamlNode root = asked.text ? YamlNode::parse(*asked.text, asked.source) : YamlNode::load(asked.source);
  if (asked.robot != nullptr) return resolve_for(read_request(root), asked.robot->parameters);
  if (asked.text) return parse_request(*asked.text, asked.source, asked.folder);
  return load_request(asked.source);
}

std::optional<WarmStart> warm_start(const Planned* from, const Problem& problem) {
  if (from == nullptr) return std::nullopt;
  if (robot_hash(from->record.robot) != robot_hash(problem.robot)) {
    throw InputError("warm", "", "is a plan for another robot");
  }
  if (!from->solution) throw InputError("warm", "", "has no solution to start from: it is not certified");
  return WarmStart{from->solution, from->record.source};
}

Planned planned(const Problem& problem, Plan plan) {
  Planned result{{problem.name, plan_json(problem, plan), problem.robot, std::move(plan.trajectory)},
                 std::move(plan.solution)};
  if (result.record.trajectory) describe(*result.record.trajectory, result.record.plan);
  return result;
}

Planned plan_request(const Asked& asked, const Planned* warm, PlanOptions options, const nb::object& progress) {
  const Problem problem = problem_of(asked);
  options.warm = warm_start(warm, problem);
  return supervised<Progress>(progress, [&](Wire<Progress>& wire) {
    options.on_progress = [&wire](const Progress& told) { wire.tell(told); };
    options.cancelled = [&wire] { return wire.cancelled(); };
    return planned(problem, plan(problem, options));
  });
}

// What stands in the document at a field of an error message, as one line of YAML; none where nothing does.
std::optional<std::string> value_at(const std::optional<std::string>& text, const std::string& source,
                                    const std::string& field) {
  YamlNode node = text ? YamlNode::parse(*text, source) : YamlNode::load(source);
  std::size_t at = 0;
  while (at < field.size()) {
    const std::size_t end = field.find_first_of(".[]", at);
    const std::string key = field.substr(at, end == std::string::npos ? end : end - at);
    if (!key.empty() && at > 0 && field[at - 1] == '[') {
      const std::size_t index = std::stoul(key);
      if (!node.is_list() || index >= node.items().size()) return std::nullopt;
      node = node.items()[index];
    } else if (!key.empty()) {
      const std::optional<YamlNode> below = node.is_map() ? node.find(key) : std::nullopt;
      if (!below) return std::nullopt;
      node = *below;
    }
    if (end == std::string::npos) break;
    at = end + 1;
  }
  return node.flow();
}

const std::vector<Sample>& samples_of(const Planned& plan) {
  static const std::vector<Sample> none;
  return plan.record.trajectory ? plan.record.trajectory->samples : none;
}

const Trajectory& trajectory_of(const Planned& plan) {
  if (!plan.record.trajectory) throw InputError(plan.record.source, "", "has no trajectory");
  return *plan.record.trajectory;
}

nb::dict interpolate(const Planned& plan, const nb::ndarray<const double, nb::ndim<1>, nb::c_contig>& times) {
  Interpolator motion(trajectory_of(plan));
  std::vector<Sample> samples(times.shape(0));
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = motion.at(times.data()[i]);
  return columns_of(std::move(samples));
}

Array mean_torque(const Planned& plan, double tick) {
  const Trajectory& trajectory = trajectory_of(plan);
  Interpolator motion(trajectory);
  const double begin = trajectory.start_time();
  std::vector<Joints<double>> means(static_cast<std::size_t>(std::ceil((trajectory.end_time() - begin) / tick - 1e-9)));
  for (std::size_t k = 0; k < means.size(); ++k) {
    const double from = begin + static_cast<double>(k) * tick;
    means[k] = motion.mean_torque(from, from + tick);
  }
  return pairs(std::move(means));
}

std::vector<std::string> save(const Planned& plan, const fs::path& folder, bool report, bool keep_uncertified) {
  const nb::gil_scoped_release others_may_run;
  fs::create_directories(folder);
  NewResults results(folder);
  const PlanRecord& record = plan.record;
  const PlanFiles files{record.plan, record.trajectory ? &*record.trajectory : nullptr, plan.solution.get()};
  std::vector<std::string> names = write_plan_files(files, results.stage(), keep_uncertified);
  if (report) names.push_back(write_report(results.stage()).filename().string());
  results.publish();
  for (std::string& name : names) name = (folder / name).string();
  return names;
}

Planned load(const fs::path& folder) {
  const FolderLock lock(folder);
  Planned plan{read_plan(folder), nullptr};
  if (fs::exists(folder / kSolutionFile)) {
    plan.solution =
        std::make_shared<const Collocated>(read_solution(folder / kSolutionFile, robot_hash(plan.record.robot)));
  }
  return plan;
}

// Rows to be certified, and what is known of the motion that they claim to be.
struct Claimed {
  const Trajectory& trajectory;
  std::string source;  // for messages
  PlannedMotion of_plan;
};

std::string verify_against_robot(Claimed claimed, const Robot& robot, const std::optional<Joints<double>>& payload,
                                 bool proven) {
  VerifyOptions options;
  if (payload) options.payload = Payload{(*payload)[0], (*payload)[1]};
  options.proven = proven;
  options.planned = std::move(claimed.of_plan);
  return json_text(
      verification_json(claimed.trajectory, verify(claimed.trajectory, claimed.source, robot.parameters, options)));
}

std::string verify_against_request(Claimed claimed, const Asked& asked, bool proven) {
  const Problem request = problem_of(asked);
  VerifyOptions options = as_asked_by(request, std::move(claimed.of_plan), claimed.trajectory);
  options.proven = options.proven || proven;
  return json_text(
      verification_json(claimed.trajectory, verify(claimed.trajectory, claimed.source, request.robot, options)));
}

Claimed claimed_by(const Planned& plan) {
  return {trajectory_of(plan), plan.record.source, planned_motion_in(plan.record.plan, plan.record.source)};
}

// Calls verify(claimed) with the rows of a file, or of the folder of a plan with what its plan.json says of them.
template <class Verify>
std::string with_claimed_in(const fs::path& path, const Verify& verify) {
  const bool is_folder = fs::is_directory(path);
  const Trajectory trajectory = read_csv(is_folder ? path / "trajectory.csv" : path);
  return verify(Claimed{trajectory, path.string(), is_folder ? planned_motion(path) : PlannedMotion{}});
}

nb::dict simulate_on(const Planned& plan, const Robot* arm, ControlMode control, double hold) {
  Simulation run;
  {
    const nb::gil_scoped_release others_may_run;
    const Parameters& own = plan.record.robot;
    run = simulate(own, arm == nullptr ? own : arm->parameters, trajectory_of(plan), control, hold);
  }
  nb::dict out = columns_of(std::move(run.samples));
  out["completed"] = run.completed;
  out["failure"] = run.failure;
  return out;
}

const char* phase_of(const Progress& progress) {
  switch (progress.phase) {
    case Phase::kFinding:
      return "finding";
    case Phase::kRefining:
      return "refining";
    case Phase::kMargins:
      return "margins";
    case Phase::kExplaining:
      return "explaining";
    case Phase::kDamping:
      return "damping";
  }
  return "";
}

template <std::size_t kColumn>
Array column_of(nb::handle_t<Planned> self) {
  return column(samples_of(nb::cast<const Planned&>(self)), kColumn, self);
}

}  // namespace

void add_plan(nb::module_& module) {
  nb::class_<Progress>(module, "Progress", "What a search is doing: see the attributes.")
      .def_ro("stage", &Progress::stage)
      .def_ro("iteration", &Progress::iteration)
      .def_ro("objective", &Progress::objective)
      .def_ro("violation", &Progress::violation)
      .def_prop_ro("phase", phase_of);

  nb::enum_<ControlMode>(module, "Control")
      .value("OPEN_LOOP", ControlMode::kOpenLoop)
      .value("CLOSED_LOOP", ControlMode::kClosedLoop)
      .value("EXECUTOR", ControlMode::kExecutor);

  nb::class_<Planned>(module, "Plan")
      .def_prop_ro("time", column_of<0>, nb::rv_policy::reference)
      .def_prop_ro("q", column_of<1>, nb::rv_policy::reference)
      .def_prop_ro("dq", column_of<2>, nb::rv_policy::reference)
      .def_prop_ro("theta", column_of<3>, nb::rv_policy::reference)
      .def_prop_ro("dtheta", column_of<4>, nb::rv_policy::reference)
      .def_prop_ro("tau", column_of<5>, nb::rv_policy::reference)
      .def_prop_ro("robot",
                   [](const Planned& plan) {
                     return Robot{plan.record.robot, plan.record.source};
                   })
      .def_prop_ro("ends_at_rest",
                   [](const Planned& plan) { return held_after(plan.record.robot, trajectory_of(plan)).has_value(); })
      .def("to_json", [](const Planned& plan) { return json_text(plan.record.plan); })
      .def("interpolate", interpolate, nb::arg("times"))
      .def("mean_torque", mean_torque, nb::arg("tick"))
      .def("save", save, nb::arg("folder"), nb::arg("report"), nb::arg("keep_uncertified"))
      .def_static("load", load, nb::arg("folder"), nb::call_guard<nb::gil_scoped_release>())
      .def(
          "page", [](const Planned& plan) { return plan_page(plan.record); }, nb::call_guard<nb::gil_scoped_release>())
      .def(
          "verify",
          [](const Planned& plan, const Robot& robot, const std::optional<Joints<double>>& payload, bool proven) {
            return verify_against_robot(claimed_by(plan), robot, payload, proven);
          },
          nb::arg("robot"), nb::arg("payload").none(), nb::arg("proven"), nb::call_guard<nb::gil_scoped_release>())
      .def(
          "verify_request",
          [](const Planned& plan, std::optional<std::string> text, std::string source, fs::path folder,
             const Robot* robot, bool proven) {
            return verify_against_request(claimed_by(plan),
                                          {std::move(text), std::move(source), std::move(folder), robot}, proven);
          },
          nb::arg("text").none(), nb::arg("source"), nb::arg("folder"), nb::arg("robot").none(), nb::arg("proven"),
          nb::call_guard<nb::gil_scoped_release>())
      .def("simulate", simulate_on, nb::arg("arm").none(), nb::arg("control"), nb::arg("hold"));

  module.def(
      "plan",
      [](std::optional<std::string> text, std::string source, fs::path folder, const Robot* robot, const Planned* warm,
         int jobs, double deadline, int starts, const std::string& linear_solver, bool proven,
         const nb::object& progress) {
        check_solver(linear_solver);
        PlanOptions options;
        options.jobs = jobs;
        options.deadline = deadline;
        options.starts = starts;
        options.linear_solver = linear_solver;
        options.proven = proven;
        return plan_request({std::move(text), std::move(source), std::move(folder), robot}, warm, std::move(options),
                            progress);
      },
      nb::arg("text").none(), nb::arg("source"), nb::arg("folder"), nb::arg("robot").none(), nb::arg("warm").none(),
      nb::arg("jobs"), nb::arg("deadline"), nb::arg("starts"), nb::arg("linear_solver"), nb::arg("proven"),
      nb::arg("progress").none());

  module.def("value_at", value_at, nb::arg("text").none(), nb::arg("source"), nb::arg("field"));
  module.def("keys", [] {
    nb::list keys;
    for (const KeyLine& key : all_keys()) {
      keys.append(nb::make_tuple(key.name, key.unit, key.meaning, key.otherwise, key.allowed));
    }
    return keys;
  });
  module.def(
      "verify_file",
      [](const fs::path& path, const Robot& robot, const std::optional<Joints<double>>& payload, bool proven) {
        return with_claimed_in(
            path, [&](Claimed claimed) { return verify_against_robot(std::move(claimed), robot, payload, proven); });
      },
      nb::arg("path"), nb::arg("robot"), nb::arg("payload").none(), nb::arg("proven"),
      nb::call_guard<nb::gil_scoped_release>());
  module.def(
      "verify_file_request",
      [](const fs::path& path, std::optional<std::string> text, std::string source, fs::path folder, const Robot* robot,
         bool proven) {
        const Asked asked{std::move(text), std::move(source), std::move(folder), robot};
        return with_claimed_in(
            path, [&](Claimed claimed) { return verify_against_request(std::move(claimed), asked, proven); });
      },
      nb::arg("path"), nb::arg("text").none(), nb::arg("source"), nb::arg("folder"), nb::arg("robot").none(),
      nb::arg("proven"), nb::call_guard<nb::gil_scoped_release>());
}

}  // namespace fjr::python
