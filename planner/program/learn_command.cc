// fjr learn: corrects a motion by the deviation of its last run from the plan.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "planner/certificate/certificate.h"
#include "planner/learning/repetition.h"
#include "planner/program/commands.h"
#include "planner/program/result_files.h"
#include "planner/results/plan_json.h"
#include "planner/results/planned_with.h"
#include "planner/results/repetition_json.h"
#include "planner/results/report/plan_record.h"
#include "planner/results/result_folder.h"
#include "planner/results/solution_file.h"
#include "planner/results/verification.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using LearntJson = nlohmann::ordered_json;

struct LearnArguments {
  std::string folder, log;
  std::string out;  // empty: the same folder
  bool json = false;
};

// The executed motion as its folder describes it.
struct ExecutedPlan {
  PlanRecord record;
  Limits limits;
  PlannedMotion task;
};

ExecutedPlan executed_plan(const std::string& folder) {
  const FolderLock lock(folder);
  ExecutedPlan plan{read_plan(folder), {}, {}};
  if (!plan.record.trajectory) {
    throw InputError(folder, "", "holds no certified trajectory: there is no motion that could be repeated");
  }
  plan.limits = limits_of(plan.record.robot, planned_with(plan.record.trajectory->metadata, folder));
  plan.task = planned_motion(folder);
  for (const LimitName& name : kLimitNames) {
    const double planned = name.in(plan.task.limits);
    if (!(planned < name.in(plan.limits))) continue;
    throw InputError((fs::path(folder) / "trajectory.csv").string(), fmt::format("# limits.{}", name.quantity->name),
                     leaves_out(name, planned) + ": the file was changed");
  }
  return plan;
}

// The log of a run to the end, of this motion on this robot.
Log log_of_run(const std::string& file, const ExecutedPlan& plan) {
  const Log log = read_log(file);
  const auto said = [&](const char* key) {
    const auto found = log.metadata.find(key);
    return found == log.metadata.end() ? std::string() : found->second;
  };
  if (const std::string code = said("code"); !code.empty() && code != "0") {
    throw InputError(file, "# code",
                     fmt::format("{}: the motion was not executed to its end: {}", code, said("sentence")));
  }
  const std::string planned_for = plan.record.plan.at("robot_hash").get<std::string>();
  if (const std::string hash = said("robot_hash"); !hash.empty() && hash != planned_for) {
    throw InputError(
        file, "# robot_hash",
        fmt::format("{}, but the motion was planned for {}: another robot, or another payload", hash, planned_for));
  }
  require_run_of(*plan.record.trajectory, plan.record.source, log);
  return log;
}

LearntJson json_of(const Repetition& repetition, const Log& log, const JsonField& plan) {
  return repetition_json(repetition, {{"log", log.source}, {"log_sha256", log.hash}}, plan);
}

// Limit of which least is left, in both rehearsals.
const LimitCheck* nearest_limit(const Repetition& repetition) {
  const LimitCheck* nearest = nullptr;
  for (const Rehearsal& rehearsal : repetition.rehearsals) {
    for (const LimitCheck& c : rehearsal.limits) {
      const auto used = [](const LimitCheck& of) { return std::max(of.reached, of.rollout) / of.limit; };
      if (nearest == nullptr || used(c) > used(*nearest)) nearest = &c;
    }
  }
  return nearest;
}

std::string text_for_people(const LearnArguments& options, const Parameters& robot, const Repetition& r,
                            const LearntJson& json, const fs::path& folder) {
  const double count = exactness_tolerance(robot);
  const auto counts = [&](const Joints<double>& angle) {
    return fmt::format("{:.3g} and {:.3g} counts rms off the plan", angle[0] / count, angle[1] / count);
  };
  std::string text = fmt::format("{}: repetition {} by {}\n  last run     links {}\n", options.folder,
                                 json.at("number").get<int>(), options.log, counts(r.link_error_rms));
  if (r.refused) {
    text += "  REFUSED      not even an eighth of the correction is within what is allowed; nothing is written\n";
  } else {
    text += fmt::format("  expected     links {}, by {}\n", counts(r.rehearsals.back().link_error_rms),
                        r.rehearsals.back().arm);
    const std::string part = r.fraction == 1  ? "all of it"
                             : r.fraction > 0 ? fmt::format("{:g} of it", r.fraction)
                                              : "none";
    text += fmt::format("  correction   {}\n", part);
  }
  bool kept = true;
  for (const std::string& reason : r.reasons) text += fmt::format("  held back    {}\n", reason);
  for (const Rehearsal& rehearsal : r.refused ? std::vector<Rehearsal>{} : r.rehearsals) {
    for (const std::string& broken : rehearsal.broken) {
      kept = false;
      text += fmt::format("  NOT KEPT     {}: {}\n", rehearsal.arm, broken);
    }
  }
  if (const LimitCheck* c = nearest_limit(r); c != nullptr && !r.refused && kept) {
    text += fmt::format("  limits       kept; nearest is {}{}: {:.4g} of {:.4g}\n", c->name,
                        c->joint > 0 ? fmt::format(" of joint {}", c->joint) : "", std::max(c->reached, c->rollout),
                        c->limit);
  }
  if (!r.refused) text += fmt::format("  files        {}\n", (folder / "trajectory.csv").string());
  return text;
}

// Writes the plan with other rows. The optimiser's solution for warm starts is still that of the plan and is copied; a
// report is not.
void write_repetition(const fs::path& from, const fs::path& to, const LearntJson& plan, Trajectory rows) {
  prepare_folder(to);
  NewResults results(to);
  rows.metadata["rows"] = std::to_string(rows.samples.size());
  tell_repetition(plan, rows.metadata);
  write_csv(rows, results.stage() / "trajectory.csv");
  if (fs::exists(from / kSolutionFile)) fs::copy_file(from / kSolutionFile, results.stage() / kSolutionFile);
  write_file(results.stage() / "plan.json", json_text(plan));
  results.publish();
}

int run(const LearnArguments& options) {
  ExecutedPlan plan = executed_plan(options.folder);
  const Log log = log_of_run(options.log, plan);
  const Parameters& robot = plan.record.robot;
  const JsonField planned(plan.record.plan, plan.record.source);
  const Repetition repetition =
      next_repetition(robot, plan.limits, TaskOfMotion::of(robot, plan.task.task, plan.task.ends),
                      *plan.record.trajectory, executed_motion(log), {motors_began_before(planned), {}});
  const LearntJson json = json_of(repetition, log, planned);
  const fs::path folder = options.out.empty() ? options.folder : options.out;
  if (!repetition.refused) {
    plan.record.plan["repetition"] = json;
    write_repetition(options.folder, folder, plan.record.plan, repetition.rows);
  }
  fmt::print("{}", options.json ? json_text(json) : text_for_people(options, robot, repetition, json, folder));
  return exit_code(repetition.refused ? PlanStatus::kUncertified : PlanStatus::kCertified);
}

}  // namespace

void add_learn(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<LearnArguments>();
  CLI::App* command =
      app.add_subcommand("learn", "Correct a motion that is repeated by what its last run was off the plan");
  command->add_option("folder", options->folder, "Folder of the plan, or of the repetition, that was executed")
      ->required()
      ->type_name("DIR");
  command->add_option("log", options->log, "The executor's log of that run")->required()->type_name("LOG.csv");
  command->add_option("--out", options->out, "Folder for the next repetition; default: DIR itself")->type_name("DIR2");
  command->add_flag("--json", options->json, "Only JSON on stdout: what is in plan.json as `repetition`");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace fjr
