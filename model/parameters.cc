#include "model/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string_view>
#include <system_error>
#include <tuple>
#include <vector>

#include "common/degrees.h"
#include "common/input_error.h"
#include "common/library_folder.h"
#include "common/sha256.h"
#include "common/strict_yaml.h"
#include "model/dynamics.h"
#include "model/plausibility.h"
#include "model/uncertainty.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

constexpr double kMostCounts = 1e9;  // per revolution; far beyond any encoder, far below where doubles skip integers

// A condition that a single value must satisfy, written so that messages can quote it.
struct Rule {
  std::string_view text;
  bool (*holds)(double);
};

constexpr Rule kPositive{"> 0", [](double v) { return v > 0; }};
constexpr Rule kNotNegative{">= 0", [](double v) { return v >= 0; }};
constexpr Rule kFraction{"from 0 to 1", [](double v) { return v >= 0 && v <= 1; }};
constexpr Rule kCounts{"a whole number from 1 to 1000000000",
                       [](double v) { return v >= 1 && v <= kMostCounts && std::floor(v) == v; }};
constexpr Rule kAny{"", [](double) { return true; }};

const Rule& rule_for(std::string_view section, std::string_view name) {
  static const std::map<std::string_view, Rule> special{
      {"link.com_fraction", kFraction},         {"link.gravity_torque", kNotNegative},
      {"link.damping", kNotNegative},           {"friction.viscous", kNotNegative},
      {"friction.amplitude", kNotNegative},     {"friction.second_weight", kAny},
      {"friction.second_shape", kAny},          {"encoder.motor_counts", kCounts},
      {"encoder.link_counts", kCounts},         {"limits.link_middle", kAny},
      {"feedback.position_gain", kNotNegative}, {"feedback.velocity_gain", kNotNegative},
      {"drive.copper_loss", kNotNegative}};
  const auto found = special.find(fmt::format("{}.{}", section, name));
  return found == special.end() ? kPositive : found->second;
}

void check(const YamlNode& list, const Joints<double>& values, const Rule& rule, std::string_view unit) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!rule.holds(values[j])) list.fail_at(j, fmt::format("{} must be {}", with_unit(values[j], unit), rule.text));
  }
}

void check_standard_error(const YamlNode& entry, std::string_view unit) {
  const YamlNode error = entry.at("standard_error");
  if (error.is_null()) return;
  const std::vector<YamlNode> joints = error.items();
  if (joints.size() != kJoints) error.pair(unit);  // says what is wrong
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (joints[j].is_null()) continue;  // known only for the other joint
    const double value = joints[j].number(unit);
    if (!kNotNegative.holds(value)) error.fail_at(j, fmt::format("{} must be >= 0", with_unit(value, unit)));
  }
}

bool names_points(std::string_view section, std::string_view name) { return section == "link" && name == "inertia"; }

// Reads one `name: {value, unit, source, standard_error}`; the links' inertia may also have `about`.
Joints<double> read_entry(const YamlNode& entry, const Rule& rule, std::string_view unit, bool has_points) {
  std::vector<std::string_view> keys{"value", "unit", "source", "standard_error"};
  if (has_points) keys.emplace_back("about");
  entry.allow_keys(keys);
  const YamlNode given_unit = entry.at("unit");
  if (given_unit.text() != unit) {
    given_unit.fail(fmt::format("{} must be \"{}\"", shown(given_unit.text()), unit));
  }
  entry.at("source").text();
  check_standard_error(entry, unit);
  const YamlNode value = entry.at("value");
  const Joints<double> values = value.pair(unit);
  check(value, values, rule, unit);
  return values;
}

// A number, or an entry with its standard error; and its node, for error messages.
struct Single {
  double number;
  double error;  // standard error; 0 where there is none
  YamlNode value;
};
Single read_single(const YamlNode& node, std::string_view unit) {
  YamlNode value = node;
  double error = 0;
  if (node.is_map()) {
    node.allow_keys({"value", "unit", "source", "standard_error"});
    const YamlNode given_unit = node.at("unit");
    if (given_unit.text() != unit) {
      given_unit.fail(fmt::format("{} must be \"{}\"", shown(given_unit.text()), unit));
    }
    if (const auto source = node.find("source")) source->text();
    value = node.at("value");
    if (const auto given = node.find("standard_error"); given && !given->is_null()) {
      error = given->number(unit);
      if (error < 0) given->fail(fmt::format("{} must be >= 0", with_unit(error, unit)));
    }
  }
  return {value.number(unit), error, value};
}

// Returns the number and its standard error.
std::pair<double, double> read_payload_value(const YamlNode& node, const PayloadBound& bound) {
  const Single single = read_single(node, bound.unit);
  bound.check(single.value, single.number);
  return {single.number, single.error};
}

double read_angle(const YamlNode& node, double lowest, double highest) {
  const auto [angle, error, value] = read_single(node, "rad");
  if (angle < lowest || angle > highest) {
    value.fail(fmt::format("{} rad is outside [{:.6g}, {:.6g}]{}", angle, lowest, highest,
                           degrees_suspected(angle, lowest, highest)));
  }
  return angle;
}

using Sections = std::vector<std::pair<std::string_view, std::vector<std::string_view>>>;

// Returns the names of visit_parameters() in its order, grouped by section.
Sections known_sections() {
  Sections sections;
  Parameters unused;
  visit_parameters(unused, [&](std::string_view section, std::string_view name, std::string_view, Joints<double>&) {
    if (sections.empty() || sections.back().first != section) sections.push_back({section, {}});
    sections.back().second.push_back(name);
  });
  return sections;
}

void check_keys(const YamlNode& root) {
  const Sections sections = known_sections();
  std::vector<std::string_view> allowed;
  for (const auto& [section, names] : sections) allowed.push_back(section);
  allowed.push_back("covariance");
  allowed.push_back("payload");
  allowed.push_back("mounting");
  root.allow_keys(allowed);
  for (const auto& [section, names] : sections) root.at(section).allow_keys(names);
}

// Converts inertias by the parallel axis theorem from the points named by `about` to those of Parameters. Without
// `about` they already refer to these.
void move_inertias(const YamlNode& root, Parameters& p) {
  const YamlNode entry = root.at("link").at("inertia");
  const auto about = entry.find("about");
  if (!about) return;
  const std::vector<YamlNode> points = about->items();
  if (points.size() != kJoints) about->fail("must be two points, [joint 1, joint 2]");
  for (std::size_t j = 0; j < kJoints; ++j) {
    const bool about_com = points[j].one_of({"joint", "center_of_mass"}) == 1;
    const double r = p.link.com_fraction[j] * p.link.length[j], moved = p.link.mass[j] * r * r;
    if (j == 0 && about_com) p.link.inertia[0] += moved;
    if (j == 1 && !about_com) {
      if (!(p.link.inertia[1] > moved)) {
        entry.at("value").fail_at(1, fmt::format("{} kg m^2 about the joint must be > {:.6g} kg m^2, which {} kg with "
                                                 "the centre of mass {:.6g} m from the joint have at least",
                                                 p.link.inertia[1], moved, p.link.mass[1], r));
      }
      p.link.inertia[1] -= moved;
    }
  }
}

void check_plausibility(const YamlNode& root, const Parameters& p) {
  for (const Finding& doubt : doubts_about(p)) {
    if (doubt.verdict == Verdict::kImpossible)
      throw InputError(root.source(), fmt::format("{}.value[{}]", doubt.field, doubt.joint - 1), doubt.sentence);
  }
}

// The determinant m11 m22 - m12^2 is quadratic in cos q2 with a negative leading coefficient: smallest at q2 = 0 or pi.
void check_mass_matrix(const YamlNode& root, const Parameters& p) {
  for (const double q2 : {0.0, std::numbers::pi}) {
    const MassMatrix<double> m = mass_matrix(p, q2);
    const double determinant = m.m11 * m.m22 - m.m12 * m.m12;
    if (!(m.m11 > 0 && determinant > 0 && std::isfinite(determinant))) {
      root.at("link").fail(fmt::format("the mass matrix is not positive definite at q2 = {:.4g} rad", q2));
    }
  }
}

// Checks that gravity cannot deflect the springs beyond the range in which they are identified.
void check_springs_hold_gravity(const YamlNode& root, const Parameters& p) {
  const Joints<double> gravity = gravity_coefficients(p), worst{gravity[0] + gravity[1], gravity[1]};
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double deflection = worst[j] / p.spring.stiffness[j];
    if (!(deflection <= p.limits.spring_deflection[j])) {
      root.at("limits")
          .at("spring_deflection")
          .at("value")
          .fail_at(j, fmt::format("{} rad is less than the {:.6g} rad by which gravity deflects this spring at rest",
                                  p.limits.spring_deflection[j], deflection));
    }
  }
}

void check_drive(const YamlNode& root, const Parameters& p) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!(p.drive.peak_torque[j] >= p.limits.torque[j])) {
      root.at("drive")
          .at("peak_torque")
          .at("value")
          .fail_at(j,
                   fmt::format("{} N m must be >= limits.torque, {} N m", p.drive.peak_torque[j], p.limits.torque[j]));
    }
  }
}

bool has_robot(const fs::path& folder) {
  std::error_code error;
  return fs::is_regular_file(folder / "robot.yaml", error);
}

// Returns the folders in which the configuration may be, relative to lib/fjr or lib/<architecture>/fjr of an
// installation and in a build tree. Folders further above are not searched, because others may have write access to
// them.
std::vector<fs::path> folders_nearby() {
  const fs::path start = library_folder();
  if (start.empty()) return {};
  const fs::path parent = start.parent_path();
  const bool in_lib = parent.filename().string().starts_with("lib");
  const fs::path prefix = (in_lib ? parent : parent.parent_path()).parent_path();
  return {prefix / "share/fjr/config", prefix / "config"};
}

}  // namespace

std::string PayloadBound::sentence_of(double value) const {
  return fmt::format("{} is outside [0, {}]", with_unit(value, unit), most);
}

Payload read_payload(const YamlNode& node) {
  Payload payload;
  const bool mass_alone = !node.is_map() || node.find("value");
  if (!mass_alone) node.allow_keys({"mass", "inertia"});
  std::tie(payload.mass, payload.mass_error) =
      read_payload_value(mass_alone ? node : node.at("mass"), kPayloadMassBound);
  if (mass_alone) return payload;
  if (const auto inertia = node.find("inertia")) {
    std::tie(payload.inertia, payload.inertia_error) = read_payload_value(*inertia, kPayloadInertiaBound);
  }
  return payload;
}

bool may_be_left_out(std::string_view section, std::string_view name) {
  return (section == "drive" && name == "copper_loss") || (section == "limits" && name == "link_middle");
}

PlaneMounting read_mounting(const YamlNode& node) {
  node.allow_keys({"inclination", "down"});
  constexpr double kUpright = std::numbers::pi / 2, kDegree = std::numbers::pi / 180;
  PlaneMounting mounting;
  if (const auto inclination = node.find("inclination")) {
    mounting.inclination = read_angle(*inclination, 0, kUpright + 0.01 * kDegree);  // 1.5708 is upright
    mounting.gravity = std::sin(mounting.inclination);
  }
  if (const auto down = node.find("down")) mounting.down = read_angle(*down, -2 * kUpright, 2 * kUpright);
  return mounting;
}

namespace {

Parameters read_entries(const YamlNode& root) {
  check_keys(root);
  Parameters p{};
  visit_parameters(
      p, [&](std::string_view section, std::string_view name, std::string_view unit, Joints<double>& value) {
        if (may_be_left_out(section, name) && !root.at(section).find(name)) return;
        value = read_entry(root.at(section).at(name), rule_for(section, name), unit, names_points(section, name));
      });
  move_inertias(root, p);
  p.uncertainty = std::make_shared<const Uncertainty>(read_uncertainty(root, p));
  if (const auto mounting = root.find("mounting")) p.mounting = read_mounting(*mounting);
  return p;
}

void read_payload_into(const YamlNode& root, Parameters& p) {
  if (const auto payload = root.find("payload")) p.payload = read_payload(*payload);
}

}  // namespace

Parameters parameters_as_written(const fs::path& file) {
  const YamlNode root = YamlNode::load(file);
  Parameters p = read_entries(root);
  read_payload_into(root, p);
  return p;
}

Parameters load_parameters(const fs::path& file) { return read_parameters(YamlNode::load(file)); }

Parameters read_parameters(const YamlNode& root) {
  Parameters p = read_entries(root);
  check_mass_matrix(root, p);  // of the arm itself: a payload is checked with each request
  check_springs_hold_gravity(root, p);
  check_drive(root, p);
  check_plausibility(root, p);
  read_payload_into(root, p);
  return p;
}

Parameters load_bare_parameters(const fs::path& file) {
  const Parameters p = load_parameters(file);
  if (p.payload != Payload{}) throw InputError(file.string(), "payload", "the experiments are made with the bare arm");
  if (p.mounting != PlaneMounting{}) {
    throw InputError(file.string(), "mounting", "the experiments are made with the arm hanging in an upright plane");
  }
  return p;
}

fs::path default_robot_file() {
  // If the user names a folder, only its robot may be used. Silently planning for another robot would be worse than an
  // error.
  if (const char* folder = std::getenv("FJR_CONFIG_DIR"); folder != nullptr && *folder != '\0') {
    if (has_robot(folder)) return fs::path(folder) / "robot.yaml";
    throw InputError("robot.yaml", "", fmt::format("not in FJR_CONFIG_DIR, {}", folder));
  }
  std::string searched;
  for (const fs::path& folder : folders_nearby()) {
    if (has_robot(folder)) return folder / "robot.yaml";
    searched += (searched.empty() ? "" : ", ") + folder.string();
  }
  throw InputError("robot.yaml", "", "not found; FJR_CONFIG_DIR is not set, searched " + searched);
}

std::string robot_hash(const Parameters& p) {
  std::vector<std::string> lines;
  std::vector<Joints<double>> left_out;  // defaults of entries that are not given
  const Parameters defaults{};
  visit_parameters(defaults, [&](auto, auto, auto, const Joints<double>& value) { left_out.push_back(value); });
  std::size_t next = 0;
  visit_parameters(
      p, [&](std::string_view section, std::string_view name, std::string_view, const Joints<double>& value) {
        if (value == left_out[next++] && may_be_left_out(section, name)) return;
        for (std::size_t j = 0; j < kJoints; ++j) {
          lines.push_back(fmt::format("{}.{}[{}]={:.17g}\n", section, name, j, value[j] + 0.0));  // -0 is 0
        }
      });
  if (p.payload != Payload{}) {
    lines.push_back(fmt::format("payload.mass={:.17g}\n", p.payload.mass));
    lines.push_back(fmt::format("payload.inertia={:.17g}\n", p.payload.inertia));
  }
  if (p.mounting != PlaneMounting{}) {
    lines.push_back(fmt::format("mounting.gravity={:.17g}\n", p.mounting.gravity));
    lines.push_back(fmt::format("mounting.down={:.17g}\n", p.mounting.down + 0.0));
  }
  std::sort(lines.begin(), lines.end());
  return sha256_hex(fmt::format("{}", fmt::join(lines, "")));
}

}  // namespace fjr
