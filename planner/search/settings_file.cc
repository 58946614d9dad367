#include "planner/search/settings_file.h"

#include <fmt/format.h>

#include <cmath>
#include <concepts>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "common/field_count.h"
#include "common/input_error.h"
#include "planner/search/settings_fields.h"

namespace fjr {
namespace {

// ---- every member has a key ----

template <class Group>
consteval std::size_t visited_fields() {
  Group group{};
  std::size_t count = 0;
  visit_fields(group, [&](const SettingKey&, auto&) { ++count; });
  return count;
}

// Does not compile if visit_fields() leaves a member of the group, or of a group in it, out.
template <class Group>
consteval bool visits_every_field() {
  static_assert(visited_fields<Group>() == field_count<Group>(), "visit_fields() leaves out a member of this group");
  Group group{};
  bool all = true;
  visit_fields(group, [&](const SettingKey&, auto& member) {
    using Member = std::remove_reference_t<decltype(member)>;
    if constexpr (SettingList<Member>) {
      if constexpr (!SettingNumber<typename Member::value_type>)
        all &= visits_every_field<typename Member::value_type>();
    } else if constexpr (!SettingNumber<Member>) {
      all &= visits_every_field<Member>();
    }
  });
  return all;
}
static_assert(visits_every_field<SearchSettings>());

// Returns a number as files have it.
std::string shown_number(double value) { return std::isinf(value) ? ".inf" : fmt::format("{}", value); }

// ---- reading ----

double number_within(const YamlNode& node, const SettingKey& key) {
  const bool infinite = key.most == kUnbounded && node.says(".inf");
  const double value = infinite ? kUnbounded : node.number(key.unit);
  if (value < key.least || value > key.most) {
    node.fail(fmt::format("{} is outside [{}, {}]", with_unit(value, key.unit), shown_number(key.least),
                          shown_number(key.most)));
  }
  return value;
}

void read_setting(const YamlNode& node, const SettingKey& key, double& value) { value = number_within(node, key); }

template <std::integral Whole>
void read_setting(const YamlNode& node, const SettingKey& key, Whole& value) {
  const double number = number_within(node, key);
  if (number != std::floor(number)) {
    node.fail(fmt::format("{} is not a whole number from {} to {}", number, key.least, key.most));
  }
  value = static_cast<Whole>(number);
}

template <SettingList List>
void read_setting(const YamlNode& node, const SettingKey& key, List& list);

template <class Group>
void read_setting(const YamlNode& node, const SettingKey&, Group& group) {
  std::vector<std::string_view> names;
  visit_fields(group, [&](const SettingKey& key, auto&) { names.emplace_back(key.name); });
  node.allow_keys(names);
  visit_fields(group, [&](const SettingKey& key, auto& member) {
    if (const auto given = node.find(key.name)) read_setting(*given, key, member);
  });
}

template <SettingList List>
void read_setting(const YamlNode& node, const SettingKey& key, List& list) {
  const std::vector<YamlNode> items = node.is_list() ? node.items() : std::vector<YamlNode>{};
  if (items.size() != list.size()) node.fail(fmt::format("must be a list of {}, not {}", list.size(), node.kind()));
  for (std::size_t i = 0; i < list.size(); ++i) read_setting(items[i], key, list[i]);
}

// ---- settings that belong together ----

struct NamedSetting {
  std::string path;
  double value;
};

void refuse_above(const NamedSetting& a, const NamedSetting& b, const std::string& source) {
  if (a.value <= b.value) return;
  throw InputError(source, a.path, fmt::format("{} is above {}, which is {}", a.value, b.path, b.value));
}

void refuse_not_below(const NamedSetting& a, const NamedSetting& b, const std::string& source) {
  if (a.value < b.value) return;
  throw InputError(source, a.path, fmt::format("{} is not below {}, which is {}", a.value, b.path, b.value));
}

// Refuses what contradicts another setting, the given ones and defaults alike.
void refuse_contradictions(const SearchSettings& s, const std::string& source) {
  const FirstSolveSettings& first = s.continuation.first;
  refuse_above({"continuation.first.fewest_intervals", static_cast<double>(first.fewest_intervals)},
               {"continuation.first.most_intervals", static_cast<double>(first.most_intervals)}, source);
  for (std::size_t i = 1; i < s.race.gaps.size(); ++i) {
    const auto width = [&](std::size_t k) {
      return NamedSetting{fmt::format("race.gaps[{}].width", k), s.race.gaps[k].width};
    };
    refuse_not_below(width(i), width(i - 1), source);
  }
  refuse_above({"stepwise.shortest_step", s.stepwise.shortest_step}, {"stepwise.first_step", s.stepwise.first_step},
               source);
  refuse_above({"stepwise.sharpest_width_factor", s.stepwise.sharpest_width_factor},
               {"stepwise.sharp_width_factor", s.stepwise.sharp_width_factor}, source);
  const MeshSettings& mesh = s.continuation.mesh;
  refuse_above({"continuation.mesh.shortest_interval", mesh.shortest_interval},
               {"continuation.mesh.shortest_interval_for_peak", mesh.shortest_interval_for_peak}, source);
  const auto duration = [&](std::size_t k) {
    return NamedSetting{fmt::format("swing_up.durations[{}]", k), s.swing_up.durations[k]};
  };
  refuse_not_below({"swing_up.swing", s.swing_up.swing}, duration(0), source);
  for (std::size_t i = 1; i < s.swing_up.durations.size(); ++i) refuse_not_below(duration(i - 1), duration(i), source);
  refuse_above({"tracking.least_stiffness", s.tracking.least_stiffness},
               {"tracking.first_stiffness", s.tracking.first_stiffness}, source);
  refuse_above({"tracking.first_stiffness", s.tracking.first_stiffness},
               {"tracking.most_stiffness", s.tracking.most_stiffness}, source);
  refuse_above({"tracking.distrusted", s.tracking.distrusted}, {"tracking.trusted", s.tracking.trusted}, source);
  refuse_above({"explanation.large_change", s.explanation.large_change}, {"slack.most", s.slack.most}, source);
  refuse_above({"budget.finding", s.budget.finding}, {"budget.refining", s.budget.refining}, source);
}

// ---- writing ----

std::string comment_on(const SettingKey& key) {
  const std::string unit = key.unit == std::string_view("1") ? "" : fmt::format("[{}] ", key.unit);
  return fmt::format("  # {}{} to {}\n", unit, shown_number(key.least), shown_number(key.most));
}

template <class Group>
void write_fields(const Group& group, std::size_t indent, std::string& text);

template <SettingNumber Number>
void write_setting(const SettingKey& key, const Number& value, std::size_t, std::string& text) {
  text += " " + shown_number(static_cast<double>(value)) + comment_on(key);
}

template <SettingList List>
void write_setting(const SettingKey& key, const List& list, std::size_t indent, std::string& text) {
  if constexpr (SettingNumber<typename List::value_type>) {
    std::vector<std::string> numbers;
    for (const auto& value : list) numbers.push_back(shown_number(static_cast<double>(value)));
    text += fmt::format(" [{}]", fmt::join(numbers, ", ")) + comment_on(key);
  } else {
    text += "\n";
    for (const auto& group : list) {
      const std::size_t begin = text.size();
      write_fields(group, indent + 4, text);
      text[begin + indent + 2] = '-';
    }
  }
}

template <class Group>
void write_setting(const SettingKey&, const Group& group, std::size_t indent, std::string& text) {
  text += "\n";
  write_fields(group, indent + 2, text);
}

template <class Group>
void write_fields(const Group& group, std::size_t indent, std::string& text) {
  visit_fields(group, [&](const SettingKey& key, const auto& member) {
    text += std::string(indent, ' ') + key.name + ":";
    write_setting(key, member, indent, text);
  });
}

}  // namespace

SearchSettings read_settings(const YamlNode& root) {
  SearchSettings settings;
  read_setting(root, SettingKey{""}, settings);
  refuse_contradictions(settings, root.source());
  return settings;
}

SearchSettings load_settings(const std::filesystem::path& file) { return read_settings(YamlNode::load(file)); }

std::string settings_yaml(const SearchSettings& settings) {
  std::string text =
      "# Settings of the search, for fjr plan --settings FILE. What a file leaves out keeps its default.\n"
      "# Behind each: its unit, and what is allowed.\n";
  write_fields(settings, 0, text);
  return text;
}

}  // namespace fjr
