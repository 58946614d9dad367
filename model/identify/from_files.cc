#include "model/identify/from_files.h"

#include <fmt/format.h>

#include <utility>

#include "common/input_error.h"
#include "model/identify/arm.h"
#include "model/identify/procedures.h"
#include "model/identify/robot_file.h"
#include "model/log.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

int joint_of(const Log& log, int given) {
  const double joint = given != 0 ? given : log.number("joint", 0);
  if (joint == 1 || joint == 2) return static_cast<int>(joint) - 1;
  throw InputError(log.source, "# joint", "is missing or neither 1 nor 2; --joint says it too");
}

Identification compare(std::vector<Estimate> estimates, const Parameters& known) {
  std::vector<Agreement> agreeing = agreements(estimates);
  std::vector<Change> changed = changes(known, combine(known, estimates));
  return {std::move(estimates), std::move(agreeing), std::move(changed)};
}

}  // namespace

std::vector<std::string> procedure_names() {
  std::vector<std::string> names;
  for (const Procedure& procedure : procedures()) names.push_back(procedure.name);
  return names;
}

Identification identify_logs(const std::string& procedure, const LogFiles& logs, const Parameters& known) {
  std::vector<Estimate> estimates;
  for (const std::string& file : logs.files) {
    const Log log = read_log(file, logs.renamed);
    estimates.push_back(identify(procedure, log, joint_of(log, logs.joint), known));
  }
  return compare(std::move(estimates), known);
}

Identification identify_folder(const std::string& folder, const ColumnNames& renamed, const Parameters& known) {
  if (!fs::is_directory(folder)) {
    throw InputError(folder, "", "'all' needs one folder with <experiment>_<joint>.csv");
  }
  std::vector<Estimate> estimates;
  for (const std::string& name : procedure_names()) {
    for (int joint = 0; joint < kJoints; ++joint) {
      const fs::path file = fs::path(folder) / fmt::format("{}_{}.csv", name, joint + 1);
      const Log log = read_log(file, renamed);
      const Parameters so_far = combine(known, estimates).robot;
      estimates.push_back(identify(name, log, joint, so_far));
    }
  }
  return compare(std::move(estimates), known);
}

void refuse_contradictions(const Identification& identification, const std::string& source) {
  for (const Agreement& a : identification.agreements) {
    if (a.standard_errors_apart() < kContradictoryApart) continue;
    throw InputError(source, "",
                     fmt::format("the logs contradict each other: {}; below {:g} is allowed, and more with "
                                 "--accept-inconsistent",
                                 a.sentence(), kContradictoryApart));
  }
}

Parameters write_robot(const fs::path& file, const fs::path& base, const Parameters& known,
                       const Identification& identification, bool use_damping) {
  return write_robot_file(file, format_robot(combine(known, identification.estimates), base, use_damping));
}

}  // namespace fjr
