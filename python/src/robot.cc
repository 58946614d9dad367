#include "python/src/robot.h"

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "common/bounded_json.h"
#include "common/input_error.h"
#include "common/strict_yaml.h"
#include "model/plausibility.h"
#include "python/src/parts.h"

namespace fjr::python {
namespace {

namespace nb = nanobind;
using Json = nlohmann::ordered_json;

std::string json_of(const Robot& robot) {
  Json json = Json::object();
  visit_parameters(robot.parameters, [&](const char* section, const char* name, const char*,
                                         const Joints<double>& values) { json[section][name] = values; });
  json["payload"] = {{"mass", robot.parameters.payload.mass}, {"inertia", robot.parameters.payload.inertia}};
  if (const PlaneMounting& mounting = robot.parameters.mounting; mounting != PlaneMounting{}) {
    json["mounting"] = {{"inclination", mounting.inclination}, {"down", mounting.down}};
  }
  return json.dump();
}

// Values as json_of() writes them, as the entries of a robot.yaml: {value: [20.48, 4.77], unit: N m/rad, source:
// given}.
std::string document_of(const Json& values) {
  Json document = values;
  Parameters units{};
  visit_parameters(units, [&](const char* section, const char* name, const char* unit, Joints<double>&) {
    if (!values.contains(section) || !values[section].is_object() || !values[section].contains(name)) return;
    document[section][name] = {
        {"value", values[section][name]}, {"unit", unit}, {"source", "given"}, {"standard_error", nullptr}};
  });
  return document.dump();
}

std::vector<std::string> doubts(const Robot& robot) {
  std::vector<std::string> sentences;
  for (const Finding& doubt : doubts_about(robot.parameters)) sentences.push_back(doubt.text());
  return sentences;
}

}  // namespace

void add_robot(nb::module_& module) {
  nb::class_<Robot>(module, "Robot")
      .def_static("load",
                  [](const std::filesystem::path& file) {
                    return Robot{load_parameters(file), file.string()};
                  })
      .def_static("from_json",
                  [](const std::string& text) {
                    const std::string source = "robot";
                    const Json values = json_from_text<Json>(text);
                    if (values.is_discarded())
                      throw InputError(source, "", "holds a number that is not finite, or is nested too deeply");
                    return Robot{read_parameters(YamlNode::parse(document_of(values), source)), source};
                  })
      .def_static("shipped_file", default_robot_file)
      .def("to_json", json_of)
      .def_ro("source", &Robot::source)
      .def_prop_ro("hash", [](const Robot& robot) { return robot_hash(robot.parameters); })
      .def_prop_ro("doubts", doubts);
}

}  // namespace fjr::python
