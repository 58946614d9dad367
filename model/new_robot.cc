#include "model/new_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include "common/degrees.h"
#include "common/input_error.h"
#include "common/rounded.h"
#include "common/strict_yaml.h"
#include "model/dynamics.h"

namespace fjr {
namespace {

// Assumptions for values that are not given.
constexpr double kPeak = 1.2;            // times the torque limit
constexpr double kSlender = 0.08;        // of a link's length, its radius
constexpr double kMotorCounts = 4096;    // per turn of the motor
constexpr double kLinkCounts = 65536;    // per turn of the joint
constexpr double kFrictionWidth = 0.05;  // [rad/s]
constexpr double kBandwidth = 30;        // [rad/s] of the motor on its feedback, as the paper's arm has it
constexpr double kOverSpring = 2;        // times the spring's stiffness, at least: the motor holds still on its side
constexpr double kDamping = 0.5;         // fraction of critical, of the motor on its feedback
constexpr double kFastest = 300;         // [rad/s] kd / J: a third of a tick's rate
constexpr double kFilterRatio = 5;       // of the feedback's bandwidth, by the cut-off of its filter
constexpr double kLeastFilter = 30;      // [Hz]
constexpr int kDigits = 4;               // of gains and filters: more would be pretended
constexpr double kTriangle = 1e-9;       // relative: rounding

// ---- reading ----

void read(const YamlNode& node, const char* unit, Joints<double>& value) { value = node.pair(unit); }
void read(const YamlNode& node, const char*, std::string& value) { value = node.text(); }

// Checks the triangle inequality of the principal moments of a body: each is at most the sum of the others.
void check_triangle(const YamlNode& node, const std::array<double, 3>& moments) {
  const double sum = moments[0] + moments[1] + moments[2];
  for (const double one : moments) {
    if (one <= (sum - one) * (1 + kTriangle)) continue;
    node.fail(fmt::format("{} kg m^2 is more than the other two moments together, {:.6g} kg m^2: no body has that", one,
                          sum - one));
  }
}

void read_moments(const YamlNode& node, const char* unit, GivenInertia& to) {
  const std::vector<YamlNode> items = node.items();
  if (items.size() != kJoints) node.pair(unit);  // says what is wrong
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!items[j].is_list()) {
      to.moments[j][2] = items[j].number(unit);
      continue;
    }
    const std::vector<YamlNode> moments = items[j].items();
    if (moments.size() != 3) items[j].fail("must be one moment, or three: [Ixx, Iyy, Izz]");
    for (std::size_t i = 0; i < 3; ++i) to.moments[j][i] = moments[i].number(unit);
    to.all_known[j] = true;
    check_triangle(items[j], to.moments[j]);
  }
}

void read(const YamlNode& node, const char* unit, GivenInertia& to) {
  if (!node.is_map()) return read_moments(node, unit, to);
  node.allow_keys({"value", "about"});
  read_moments(node.at("value"), unit, to);
  const YamlNode about = node.at("about");
  const std::vector<YamlNode> points = about.is_list() ? about.items() : std::vector<YamlNode>(kJoints, about);
  if (points.size() != kJoints) about.fail("must be one point for both links, or two, [joint 1, joint 2]");
  for (std::size_t j = 0; j < kJoints; ++j) {
    to.about_center_of_mass[j] = points[j].one_of({"joint", "center_of_mass"}) == 1;
  }
}

void read(const YamlNode& node, const char* unit, GivenRange& range) {
  const std::vector<YamlNode> items = node.items();
  const bool pairs = std::any_of(items.begin(), items.end(), [](const YamlNode& item) { return item.is_list(); });
  if (items.size() != kJoints || !pairs) {
    range.highest = node.pair(unit);
    for (std::size_t j = 0; j < kJoints; ++j) range.lowest[j] = -range.highest[j];
  } else {
    for (std::size_t j = 0; j < kJoints; ++j) {
      const Joints<double> ends = items[j].pair(unit);
      range.lowest[j] = ends[0];
      range.highest[j] = ends[1];
    }
  }
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double low = range.lowest[j], high = range.highest[j];
    if (!(high > low)) node.fail_at(j, fmt::format("{} to {} rad is no range", low, high));
    const double pi = std::numbers::pi, largest = std::max(std::abs(low), std::abs(high));
    if (largest > 4 * pi) {
      node.fail_at(j, fmt::format("{} rad is more than two turns{}", largest, degrees_suspected(largest, 0, 4 * pi)));
    }
  }
}

void read(const YamlNode& node, const char*, GivenFriction& friction) {
  node.allow_keys({"viscous", "coulomb", "width"});
  friction.viscous = node.at("viscous").pair("N m s/rad");
  friction.coulomb = node.at("coulomb").pair("N m");
  if (const auto width = node.find("width")) friction.width = width->pair("rad/s");
}

template <class T>
void read(const YamlNode& node, const char* unit, std::optional<T>& value) {
  if constexpr (std::is_same_v<T, YamlNode>) {
    value = node;
  } else {
    read(node, unit, value.emplace());
  }
}

// Returns whether a value may be zero; all others must be positive, except for a center_of_mass of 0 (check_sign()).
bool may_be_zero(std::string_view key) { return key == "gravity_torque" || key == "damping"; }

void check_sign(const Key& key, const YamlNode& node, const Joints<double>& values) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (values[j] > 0 || (values[j] == 0 && may_be_zero(key.name))) continue;
    if (key.name == std::string_view("center_of_mass") && values[j] == 0) continue;  // a balanced link
    node.fail_at(j, fmt::format("{} must be > 0", with_unit(values[j], key.unit)));
  }
}

template <class T>
void check_sign(const Key&, const YamlNode&, const T&) {}
void check_sign(const Key& key, const YamlNode& node, const std::optional<Joints<double>>& values) {
  if (values) check_sign(key, node, *values);
}

template <class T>
void read_member(const Key& key, const YamlNode& node, T& member) {
  read(node, key.unit, member);
  check_sign(key, node, member);
}

// ---- writing ----

// An entry of robot.yaml and its origin.
struct Entry {
  Joints<double> value;
  std::string source;
  std::string key;  // key of the description from which it is computed; empty for an assumed value
  std::string about;
  std::string error = "null";
};

// Rounds away the digits that are only rounding errors, so that 0.12 / 0.25 gives 0.48.
Joints<double> rounded(const Joints<double>& values, int digits = 15) {
  return {rounded_to(values[0], digits), rounded_to(values[1], digits)};
}

// Returns the text as a single line, for a comment.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  return text;
}

Joints<double> product(const Joints<double>& a, const Joints<double>& b) { return {a[0] * b[0], a[1] * b[1]}; }

class Writer {
 public:
  explicit Writer(const RobotDescription& d) : d_(d), given_(d.source.value_or("given to fjr robot new")) {
    links();
    drives();
    limits();
    feedback();
  }

  // Returns the key of the description from which an entry of robot.yaml, such as "link.mass", is computed; empty if
  // there is none.
  std::string key_of(const std::string& entry) const {
    const auto found = entries_.find(entry);
    return found == entries_.end() ? "" : found->second.key;
  }

  std::string text() const {
    std::string text = fmt::format(
        "# {}\n# SI units; motor quantities are in link coordinates, after the gear; [joint 1, joint 2] everywhere.\n"
        "# source: where a value is from; `computed:` from others, `assumption:` chosen where nothing was given.\n",
        one_line(d_.name.value_or("An arm, written by fjr robot new.")));
    std::string before;
    const Parameters unused{};
    visit_parameters(unused, [&](const std::string& section, const std::string& name, const char* unit, const auto&) {
      const auto found = entries_.find(section + "." + name);
      if (found == entries_.end()) return refuse_to_leave_out(section, name);
      if (section != before) text += fmt::format("\n{}:\n", section);
      before = section;
      const Entry& e = found->second;
      text += fmt::format("  {}: {{value: [{}, {}],{} unit: \"{}\", source: {}, standard_error: {}}}\n", name,
                          e.value[0], e.value[1], e.about, unit, quoted_flow(e.source), e.error);
    });
    if (d_.mounting) text += fmt::format("\nmounting: {}\n", d_.mounting->flow());
    if (d_.payload) text += fmt::format("\npayload: {}\n", d_.payload->flow());
    return text;
  }

 private:
  // Throws unless the file may be without this entry, so that no file is written that load_parameters() refuses.
  static void refuse_to_leave_out(const std::string& section, const std::string& name) {
    if (may_be_left_out(section, name)) return;
    throw std::logic_error(fmt::format("a new robot has no {}.{}, which every robot.yaml needs", section, name));
  }

  void put(const std::string& name, const Joints<double>& value, const std::string& source, const char* key = "",
           const std::string& error = "null") {
    entries_[name] = {value, source, key, "", error};
  }
  void given(const std::string& name, const Joints<double>& value, const char* key) {
    put(name, value, given_, key, error_of(key, {1, 1}));
  }
  void given_or(const std::string& name, const std::optional<Joints<double>>& value, const char* key,
                const Joints<double>& otherwise, const std::string& assumption) {
    if (value) return given(name, *value, key);
    put(name, otherwise, assumption);
  }

  // Returns the standard error of a key of the description, in the unit of the entry.
  std::string error_of(const char* key, const Joints<double>& factor) const {
    const auto found = d_.standard_error ? d_.standard_error->find(key) : std::nullopt;
    if (!found) return "null";
    const Joints<double> error = found->pair("");
    return fmt::format("[{}]", fmt::join(rounded(product(error, factor)), ", "));
  }

  void links() {
    const Joints<double> inverse{1 / d_.length[0], 1 / d_.length[1]};
    given("link.length", d_.length, "length");
    given("link.mass", d_.mass, "mass");
    put("link.com_fraction", rounded(product(d_.center_of_mass, inverse)),
        given_ + "; computed: center_of_mass / length", "center_of_mass", error_of("center_of_mass", inverse));
    const auto point = [&](std::size_t j) { return d_.inertia.about_center_of_mass[j] ? "center_of_mass" : "joint"; };
    given("link.inertia", {d_.inertia.moments[0][2], d_.inertia.moments[1][2]}, "inertia");
    entries_["link.inertia"].about = fmt::format(" about: [{}, {}],", point(0), point(1));
    const double second = d_.mass[1] * d_.center_of_mass[1] * kPaperGravity;
    const double first = (d_.mass[0] * d_.center_of_mass[0] + d_.mass[1] * d_.length[0]) * kPaperGravity;
    given_or("link.gravity_torque", d_.gravity_torque, "gravity_torque", rounded({first, second}),
             fmt::format("computed: masses, lengths and centres of mass, with {} m/s^2", kPaperGravity));
    given_or("link.damping", d_.damping, "damping", {0, 0}, "assumption: none");
    given_or("link.radius", d_.radius, "radius", rounded({kSlender * d_.length[0], kSlender * d_.length[1]}),
             fmt::format("assumption: {:.0f} % of the lengths", 100 * kSlender));
    given("spring.stiffness", d_.stiffness, "stiffness");
  }

  void drives() {
    const Joints<double> square = product(d_.gear, d_.gear);
    inertia_ = product(d_.rotor_inertia, square);
    put("motor.inertia", rounded(inertia_), given_ + "; computed: rotor_inertia gear^2", "rotor_inertia",
        error_of("rotor_inertia", square));
    const GivenFriction none{};
    const GivenFriction& f = d_.friction ? *d_.friction : none;
    const std::string source = d_.friction ? given_ : "assumption: no friction";
    put("friction.viscous", f.viscous, source, "friction.viscous");
    put("friction.amplitude", f.coulomb, source, "friction.coulomb");
    const bool width = f.width.has_value();
    put("friction.width", f.width.value_or(Joints<double>{kFrictionWidth, kFrictionWidth}),
        width ? source : "assumption: where friction turns its sign", width ? "friction.width" : "");
    put("friction.second_weight", {0, 0}, "assumption: Coulomb and viscous friction alone");
    put("friction.second_shape", {0, 0}, "assumption: of no account with a weight of 0");
    const Joints<double> counts = d_.motor_encoder.value_or(Joints<double>{kMotorCounts, kMotorCounts});
    put("encoder.motor_counts", {std::round(counts[0] * d_.gear[0]), std::round(counts[1] * d_.gear[1])},
        (d_.motor_encoder ? given_ : fmt::format("assumption: {} per turn of the motor", kMotorCounts)) +
            "; computed: times gear",
        d_.motor_encoder ? "motor_encoder" : "");
    given_or("encoder.link_counts", d_.link_encoder, "link_encoder", {kLinkCounts, kLinkCounts},
             fmt::format("assumption: {} per turn", kLinkCounts));
  }

  void limits() {
    given("limits.torque", d_.torque, "torque");
    given("limits.motor_velocity", d_.velocity, "velocity");
    const auto& [low, high] = d_.position;
    const bool symmetric = high[0] + low[0] == 0 && high[1] + low[1] == 0;
    const Joints<double> half{(high[0] - low[0]) / 2, (high[1] - low[1]) / 2};
    put("limits.link_position", symmetric ? high : rounded(half), given_ + ": half of the range", "position");
    if (!symmetric) {
      put("limits.link_middle", rounded({(high[0] + low[0]) / 2, (high[1] + low[1]) / 2}),
          given_ + ": middle of the range", "position");
    }
    given("limits.spring_deflection", d_.deflection, "deflection");
    given_or("drive.peak_torque", d_.peak_torque, "peak_torque", rounded({kPeak * d_.torque[0], kPeak * d_.torque[1]}),
             fmt::format("assumption: {} times the planning limit", kPeak));
  }

  // Returns the inertias [kg m^2] of the links about their joints, with the other joint locked and the arm stretched.
  Joints<double> link_inertia() const {
    Joints<double> about_joint{};
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double r = d_.center_of_mass[j], given = d_.inertia.moments[j][2];
      about_joint[j] = given + (d_.inertia.about_center_of_mass[j] ? d_.mass[j] * r * r : 0);
    }
    const double l1 = d_.length[0];
    const double outer = d_.mass[1] * l1 * (l1 + 2 * d_.center_of_mass[1]);
    return {about_joint[0] + about_joint[1] + outer, about_joint[1]};
  }

  // Chooses feedback gains. The motor alone, J s^2 + kd s + kp, must be damped. The links oscillate on springs whose
  // other end the motor holds. They are damped most if the motor's impedance kd w is about that of both springs, K +
  // kp, unless a light motor would then have to be faster than tick and filter permit.
  void feedback() {
    Joints<double> position{}, velocity{}, filter{};
    const Joints<double> links = link_inertia();
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double inertia = inertia_[j], spring = d_.stiffness[j];
      position[j] = std::max(inertia * kBandwidth * kBandwidth, kOverSpring * spring);
      const double matched = (position[j] + spring) / std::sqrt(spring / links[j]);
      velocity[j] = std::max(2 * kDamping * std::sqrt(position[j] * inertia), std::min(matched, inertia * kFastest));
      const double bandwidth = std::max(kFilterRatio * std::sqrt(position[j] / inertia), 2 * velocity[j] / inertia);
      filter[j] = std::max(kLeastFilter, bandwidth / (2 * std::numbers::pi));
    }
    const std::string how = fmt::format("assumption: the motor alone at {} rad/s or more, and {} times the spring",
                                        kBandwidth, kOverSpring);
    put("feedback.position_gain", rounded(position, kDigits), how);
    put("feedback.velocity_gain", rounded(velocity, kDigits), "assumption: damps the links on their springs");
    put("feedback.velocity_filter", rounded(filter, kDigits), "assumption: well above the feedback's bandwidth");
  }

  const RobotDescription& d_;
  std::string given_;
  Joints<double> inertia_{};
  std::map<std::string, Entry> entries_;
};

void check_standard_errors(const YamlNode& errors) {
  std::vector<std::string_view> allowed;
  for (const Key& key : description_keys()) {
    const std::string_view name = key.name;
    const bool derived = name == "gear" || name == "friction" || name == "position" || name == "motor_encoder";
    if (std::string_view(key.unit) != "" && !derived && name != "payload") allowed.push_back(key.name);
  }
  errors.allow_keys(allowed);
  for (const std::string& key : errors.keys()) {
    const YamlNode node = errors.at(key);
    const Joints<double> values = node.pair("");
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (values[j] < 0) node.fail_at(j, fmt::format("{} must be >= 0", values[j]));
    }
  }
}

// Converts an error about robot.yaml to one about the description it was made from: link.inertia.value[0] is
// inertia[0].
InputError in_terms_of(const Writer& writer, const InputError& error) {
  const std::string& field = error.field();
  const std::string entry = field.substr(0, std::min(field.find(".value"), field.find('[')));
  const std::string key = writer.key_of(entry), index = field.ends_with(']') ? field.substr(field.rfind('[')) : "";
  return {error.source(), key.empty() ? field : key + index, error.problem()};
}

void check_parts(const RobotDescription& d) {
  if (d.standard_error) check_standard_errors(*d.standard_error);
  if (d.mounting) read_mounting(*d.mounting);
  if (d.payload) read_payload(*d.payload);
}

}  // namespace

std::vector<Key> description_keys() {
  std::vector<Key> keys;
  RobotDescription unused;
  visit(unused, [&](const Key& key, auto&) { keys.push_back(key); });
  return keys;
}

void check_answer(const Key& key, const YamlNode& value) {
  RobotDescription d;
  visit(d, [&](const Key& other, auto& member) {
    if (std::string_view(other.name) == key.name) read_member(other, value, member);
  });
  check_parts(d);
}

RobotDescription read_description(const YamlNode& root) {
  std::vector<std::string_view> names;
  for (const Key& key : description_keys()) names.emplace_back(key.name);
  root.allow_keys(names);
  RobotDescription d;
  visit(d, [&](const Key& key, auto& member) {
    if (const auto node = key.required() ? root.at(key.name) : root.find(key.name)) read_member(key, *node, member);
  });
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (d.center_of_mass[j] > d.length[j]) {
      root.at("center_of_mass")
          .fail_at(j, fmt::format("{} m is beyond the end of the link, {} m from its joint", d.center_of_mass[j],
                                  d.length[j]));
    }
  }
  check_parts(d);
  return d;
}

NewRobot new_robot(const YamlNode& root) {
  const RobotDescription description = read_description(root);
  const Writer writer(description);
  NewRobot robot{writer.text(), {}};
  try {
    robot.parameters = read_parameters(YamlNode::parse(robot.yaml, root.source()));
  } catch (const InputError& error) {
    throw in_terms_of(writer, error);
  }
  return robot;
}

}  // namespace fjr
