#include "model/rig/rig_file.h"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "common/strict_yaml.h"

namespace fjr {
namespace {

constexpr double kMostRows = 1e7;  // of a log

struct Range {
  double low, high;
};
constexpr Range kNotNegative{0, 1e3}, kAngle{1e-6, 3.2}, kSeconds{1e-3, 1e4}, kRate{1, 2e4}, kSpeed{1e-6, 100},
    kTorque{1e-3, 1e3}, kCount{2, 1e5};

void require(const YamlNode& node, double value, const Range& range, std::string_view unit) {
  if (value >= range.low && value <= range.high) return;
  node.fail(fmt::format("{} is outside [{}, {}]", with_unit(value, unit), range.low, with_unit(range.high, unit)));
}

// One number for both joints, or one each.
Joints<double> number_or_pair(const YamlNode& node, std::string_view unit) {
  if (node.is_list()) return node.pair(unit);
  const double both = node.number(unit);
  return {both, both};
}

// Calls store(joint, value) for both joints where the key is given.
template <class Store>
void read(const YamlNode& map, std::string_view key, std::string_view unit, const Range& range, Store&& store) {
  const auto node = map.find(key);
  if (!node) return;
  const Joints<double> values = number_or_pair(*node, unit);
  for (std::size_t j = 0; j < kJoints; ++j) {
    require(*node, values[j], range, unit);
    store(j, values[j]);
  }
}

bool truth_of(const YamlNode& node) {
  if (!node.says("true") && !node.says("false")) node.fail("must be true or false");
  return node.says("true");
}

template <class Store>
void read_truth(const YamlNode& map, std::string_view key, Store&& store) {
  if (const auto node = map.find(key)) store(truth_of(*node));
}

// Two lists, of joint 1 and of joint 2.
template <class Store>
void read_lists(const YamlNode& map, std::string_view key, std::string_view unit, const Range& range, Store&& store) {
  const auto node = map.find(key);
  if (!node) return;
  if (!node->is_list() || node->items().size() != kJoints) node->fail("must be two lists, of joint 1 and of joint 2");
  for (std::size_t j = 0; j < kJoints; ++j) {
    std::vector<double> values;
    for (const YamlNode& item : node->items()[j].items()) {
      values.push_back(item.number(unit));
      require(item, values.back(), range, unit);
    }
    if (values.empty()) node->fail_at(j, "is empty");
    store(j, std::move(values));
  }
}

void require_rows(const YamlNode& map, double duration, double sample_rate) {
  if (duration * sample_rate <= kMostRows) return;
  map.fail(fmt::format("{:.3g} rows at {}; at most {:.0e}", duration * sample_rate, with_unit(sample_rate, "Hz"),
                       kMostRows));
}

void read_experiment(const YamlNode& map, const ExperimentInfo& info, Joints<Staircase>& to) {
  std::vector<std::string_view> keys{"steps", "step", "period", "move", "average", "sample_rate"};
  if (!info.clamped_links) keys.push_back("gravity");
  map.allow_keys(keys);
  read(map, "steps", "1", kCount, [&](std::size_t j, double v) {
    if (v != std::floor(v)) map.at("steps").fail(fmt::format("{} is not a whole number", v));
    to[j].steps = static_cast<int>(v);
  });
  read(map, "step", "rad", kAngle, [&](std::size_t j, double v) { to[j].step = v; });
  read(map, "period", "s", kSeconds, [&](std::size_t j, double v) { to[j].period = v; });
  read(map, "move", "s", kSeconds, [&](std::size_t j, double v) { to[j].move = v; });
  read(map, "average", "s", kSeconds, [&](std::size_t j, double v) { to[j].average = v; });
  read(map, "sample_rate", "Hz", kRate, [&](std::size_t j, double v) { to[j].sample_rate = v; });
  read_truth(map, "gravity", [&](bool v) { to[0].gravity = to[1].gravity = v; });
  for (const Staircase& s : to) {
    if (s.move + s.average > s.period) map.fail("move and average together are longer than period");
    if (s.steps * s.step > kAngle.high) map.fail(fmt::format("steps times step is beyond {} rad", kAngle.high));
    require_rows(map, 4 * s.steps * s.period, s.sample_rate);
  }
}

void read_experiment(const YamlNode& map, const ExperimentInfo&, Joints<Impulse>& to) {
  map.allow_keys({"amplitude", "duration", "sample_rate", "gravity"});
  read(map, "amplitude", "rad", kAngle, [&](std::size_t j, double v) { to[j].amplitude = v; });
  read(map, "duration", "s", {0.5, 1e4}, [&](std::size_t j, double v) { to[j].duration = v; });
  read(map, "sample_rate", "Hz", kRate, [&](std::size_t j, double v) { to[j].sample_rate = v; });
  read_truth(map, "gravity", [&](bool v) { to[0].gravity = to[1].gravity = v; });
  for (const Impulse& i : to) require_rows(map, i.duration, i.sample_rate);
}

void read_experiment(const YamlNode& map, const ExperimentInfo&, Joints<ConstantSpeeds>& to) {
  map.allow_keys({"speeds", "ramp", "hold", "sample_rate"});
  read_lists(map, "speeds", "rad/s", kSpeed,
             [&](std::size_t j, std::vector<double> v) { to[j].speeds = std::move(v); });
  read(map, "ramp", "s", kSeconds, [&](std::size_t j, double v) { to[j].ramp = v; });
  read(map, "hold", "s", kSeconds, [&](std::size_t j, double v) { to[j].hold = v; });
  read(map, "sample_rate", "Hz", kRate, [&](std::size_t j, double v) { to[j].sample_rate = v; });
  for (const ConstantSpeeds& s : to) {
    require_rows(map, 2 * static_cast<double>(s.speeds.size()) * (s.ramp + s.hold), s.sample_rate);
  }
}

void read_experiment(const YamlNode& map, const ExperimentInfo&, Joints<ConstantTorques>& to) {
  map.allow_keys({"torques", "rest", "push", "sample_rate"});
  read_lists(map, "torques", "N m", kTorque,
             [&](std::size_t j, std::vector<double> v) { to[j].torques = std::move(v); });
  read(map, "rest", "s", kSeconds, [&](std::size_t j, double v) { to[j].rest = v; });
  read(map, "push", "s", kSeconds, [&](std::size_t j, double v) { to[j].push = v; });
  read(map, "sample_rate", "Hz", kRate, [&](std::size_t j, double v) { to[j].sample_rate = v; });
  for (const ConstantTorques& t : to) {
    require_rows(map, 2 * static_cast<double>(t.torques.size()) * (t.rest + t.push), t.sample_rate);
  }
}

void read_instruments(const YamlNode& map, Rig& rig) {
  map.allow_keys({"torque_noise", "velocity_noise", "quantisation", "motor_counts", "link_counts"});
  const Range counts{2, 1e9};
  read(map, "torque_noise", "N m", kNotNegative, [&](auto j, double v) { rig.instruments.torque_noise[j] = v; });
  read(map, "velocity_noise", "rad/s", kNotNegative, [&](auto j, double v) { rig.instruments.velocity_noise[j] = v; });
  read_truth(map, "quantisation", [&](bool v) { rig.instruments.encoders = v; });
  read(map, "motor_counts", "1/rev", counts, [&](auto j, double v) { rig.truth.encoder.motor_counts[j] = v; });
  read(map, "link_counts", "1/rev", counts, [&](auto j, double v) { rig.truth.encoder.link_counts[j] = v; });
}

void read_hysteresis(const YamlNode& map, Hysteresis& to) {
  map.allow_keys({"height", "width"});
  read(map, "height", "N m", kNotNegative, [&](auto j, double v) { to.height[j] = v; });
  read(map, "width", "rad", kAngle, [&](auto j, double v) { to.width[j] = v; });
}

}  // namespace

void read_rig(const std::filesystem::path& file, RigSetup& setup) {
  const YamlNode root = YamlNode::load(file);
  const std::vector<std::string> names = experiment_names();
  std::vector<std::string_view> keys{"seed", "link_damping", "hysteresis", "instruments"};
  keys.insert(keys.end(), names.begin(), names.end());
  root.allow_keys(keys);
  Rig& rig = setup.rig;
  if (const auto node = root.find("seed")) rig.seed = node->whole_number();
  read(root, "link_damping", "N m s/rad", kNotNegative, [&](auto j, double v) { rig.truth.link.damping[j] = v; });
  if (const auto node = root.find("hysteresis")) read_hysteresis(*node, rig.hysteresis);
  if (const auto node = root.find("instruments")) read_instruments(*node, rig);
  visit_experiments(setup.experiments, [&](const ExperimentInfo& info, auto& how, auto&&) {
    if (const auto node = root.find(info.name)) read_experiment(*node, info, how);
  });
}

}  // namespace fjr
