#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <filesystem>
#include <string>
#include <vector>

#include "model/identify/from_files.h"
#include "model/identify/report.h"
#include "model/log.h"
#include "python/src/robot.h"

namespace fjr::python {
namespace {

namespace nb = nanobind;
namespace fs = std::filesystem;

nb::list parameters_of(const Estimate& e) {
  nb::list parameters;
  for (std::size_t i = 0; i < e.names.size(); ++i) {
    parameters.append(nb::make_tuple(e.names[i], e.value[static_cast<Eigen::Index>(i)], e.units[i],
                                     e.standard_error(e.names[i]), e.is_assumed(e.names[i])));
  }
  return parameters;
}

nb::list covariance_of(const Estimate& e) {
  nb::list rows;
  for (Eigen::Index i = 0; i < e.covariance.rows(); ++i) {
    nb::list row;
    for (Eigen::Index j = 0; j < e.covariance.cols(); ++j) row.append(e.covariance(i, j));
    rows.append(row);
  }
  return rows;
}

std::vector<std::string> warnings_of(const Identification& found) {
  std::vector<std::string> warnings;
  for (const Agreement& a : found.agreements) {
    if (a.standard_errors_apart() >= kDoubtfulApart) warnings.push_back(a.sentence());
  }
  for (const Change& change : found.changes) {
    if (change.is_large()) warnings.push_back(change.sentence());
  }
  return warnings;
}

// name: a procedure, or "all", then `logs` is one folder.
Identification identify_as_asked(const std::string& name, const std::vector<std::string>& logs, int joint,
                                 const std::map<std::string, std::string>& columns, const fs::path& base) {
  const nb::gil_scoped_release others_may_run;
  const Parameters known = load_bare_parameters(base);
  const ColumnNames renamed(columns.begin(), columns.end());
  return name == "all" ? identify_folder(logs.front(), renamed, known)
                       : identify_logs(name, {logs, joint, renamed}, known);
}

Robot write(const Identification& found, const fs::path& file, const fs::path& base, bool link_damping) {
  return {write_robot(file, base, load_bare_parameters(base), found, link_damping), file.string()};
}

}  // namespace

void add_identification(nb::module_& module) {
  nb::class_<Estimate>(module, "Estimate")
      .def_ro("procedure", &Estimate::procedure)
      .def_prop_ro("joint", [](const Estimate& e) { return e.joint + 1; })
      .def_ro("log", &Estimate::log)
      .def_ro("sha256", &Estimate::hash)
      .def_prop_ro("parameters", parameters_of)
      .def_prop_ro("covariance", covariance_of)
      .def_ro("points", &Estimate::points)
      .def_ro("residual_rms", &Estimate::residual_rms)
      .def_ro("residual_unit", &Estimate::residual_unit)
      .def_ro("r_squared", &Estimate::r_squared)
      .def_ro("warnings", &Estimate::warnings);
  nb::class_<Identification>(module, "Identification")
      .def_prop_ro("estimates", [](const Identification& found) { return found.estimates; })
      .def_prop_ro("warnings", warnings_of)
      .def("refuse_contradictions", refuse_contradictions, nb::arg("source"))
      .def("write", write, nb::arg("file"), nb::arg("base"), nb::arg("link_damping"))
      .def("report",
           [](const Identification& found) { return format_identification_report(found.estimates, found.changes); });
  nb::list procedures;
  for (const std::string& name : procedure_names()) procedures.append(name);
  module.attr("procedures") = nb::tuple(procedures);
  module.def("identify", identify_as_asked, nb::arg("name"), nb::arg("logs"), nb::arg("joint"), nb::arg("columns"),
             nb::arg("base"));
}

}  // namespace fjr::python
