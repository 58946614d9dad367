// Files of settings: what is read of them, with which words they are refused, and that they count.
#include "planner/search/settings_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <concepts>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <regex>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "common/input_error.h"
#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/results/plan_json.h"
#include "planner/search/settings_fields.h"
#include "tests/support/mutated_text.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;
using testing::AllOf;
using testing::EndsWith;
using testing::StartsWith;

SearchSettings read(const std::string& yaml) { return read_settings(YamlNode::parse(yaml, "settings.yaml")); }

std::string error_of(const std::string& yaml) {
  try {
    (void)read(yaml);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// Calls visit(key, number) for every number, those in lists one by one.
template <class S, class Visit>
void visit_numbers(S& settings, const Visit& visit) {
  visit_all_settings(settings, [&](const std::string& path, const SettingKey& key, auto& value) {
    if constexpr (SettingNumber<std::remove_reference_t<decltype(value)>>) {
      visit(path, key, value);
    } else {
      for (std::size_t i = 0; i < value.size(); ++i) visit(path + "[" + std::to_string(i) + "]", key, value[i]);
    }
  });
}

std::map<std::string, double> numbers_of(const SearchSettings& settings) {
  std::map<std::string, double> numbers;
  visit_numbers(settings, [&](const std::string& path, const SettingKey&, const auto& number) {
    numbers[path] = static_cast<double>(number);
  });
  return numbers;
}

Problem request(const std::string& yaml) {
  return parse_request(yaml, "request.yaml", FJR_SOURCE_DIR "/config", FJR_SOURCE_DIR "/config/robot.yaml");
}

// ---- the list ----

TEST(SettingsFields, AreNamedAsTheirMembers) {
  std::ifstream file(FJR_SOURCE_DIR "/planner/search/settings_fields.h");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::regex line(R"re(  visit\((?:\{|\w+\()"(\w+)"[^;]*, s\.(\w+)\);)re");
  std::size_t lines = 0;
  for (std::sregex_iterator match(text.begin(), text.end(), line), end; match != end; ++match, ++lines) {
    EXPECT_EQ((*match)[1], (*match)[2]);
  }
  EXPECT_GT(lines, 200u);
}

TEST(SettingsFields, AreEachVisitedOnce) {
  SearchSettings settings;
  std::set<std::string> paths;
  std::set<const void*> members;
  std::size_t count = 0;
  visit_numbers(settings, [&](const std::string& path, const SettingKey&, const auto& number) {
    paths.insert(path);
    members.insert(&number);
    ++count;
  });
  EXPECT_EQ(paths.size(), count);
  EXPECT_EQ(members.size(), count);
}

// ---- writing and reading ----

TEST(SettingsFile, WithTheDefaultsIsReadAsThese) {
  const SearchSettings again = read(settings_yaml({}));
  EXPECT_EQ(numbers_of(again), numbers_of({}));
  EXPECT_EQ(settings_json(again), Json::object());
  EXPECT_EQ(settings_yaml(again), settings_yaml({}));
}

// The middle of what is allowed is no default of any but a few of them. (The widths of the gaps must
// differ, and durations increase.)
TEST(SettingsFile, WithOtherValuesIsReadAsThese) {
  SearchSettings settings;
  visit_numbers(settings, [](const std::string& path, const SettingKey& key, auto& number) {
    if (path.ends_with("].width")) return;
    number = static_cast<std::remove_reference_t<decltype(number)>>(std::midpoint(key.least, key.most));
  });
  settings.swing_up.durations = {11, 12, 13};
  const SearchSettings again = read(settings_yaml(settings));
  EXPECT_EQ(numbers_of(again), numbers_of(settings));
  EXPECT_EQ(settings_json(again), settings_json(settings));
  EXPECT_GT(settings_json(again).size(), 150u);
}

TEST(SettingsFile, SaysWhatIsToBeDifferent) {
  const SearchSettings settings = read(
      "continuation:\n  mesh: {tolerance: 1e-6}\nfollow: {most: 7}\n"
      "race: {gaps: [{distance: 0.5}, {width: 0.02}, {}], last_gap: .inf}\nfallbacks: {relaxed: [1, 2]}\n");
  std::map<std::string, double> expected = numbers_of({});
  expected["continuation.mesh.tolerance"] = 1e-6;
  expected["follow.most"] = 7;
  expected["race.gaps[0].distance"] = 0.5;
  expected["race.gaps[1].width"] = 0.02;
  expected["race.last_gap"] = INFINITY;
  expected["fallbacks.relaxed[0]"] = 1;
  expected["fallbacks.relaxed[1]"] = 2;
  EXPECT_EQ(numbers_of(settings), expected);
  const Json told{{"continuation.mesh.tolerance", 1e-6}, {"follow.most", 7},         {"race.gaps[0].distance", 0.5},
                  {"race.gaps[1].width", 0.02},          {"race.last_gap", nullptr}, {"fallbacks.relaxed", {1.0, 2.0}}};
  EXPECT_EQ(settings_json(settings), told);
}

// ---- refusals ----

TEST(SettingsFile, WithUnknownKeysIsRefused) {
  EXPECT_EQ(error_of("publication: {round: 2}"),
            "settings.yaml: publication: unknown key \"round\"; allowed: rounds, finer_rows, "
            "rounds_by_accuracy, shorter_rests; did you mean rounds?");
  EXPECT_THAT(error_of("folow: {most: 5}"),
              AllOf(StartsWith("settings.yaml: unknown key \"folow\"; allowed: continuation, "),
                    EndsWith(", budget; did you mean follow?")));
  EXPECT_EQ(error_of("race: {gaps: [{}, {widht: 1}, {}]}"),
            "settings.yaml: race.gaps[1]: unknown key \"widht\"; allowed: width, distance; did you mean width?");
}

TEST(SettingsFile, WithValuesOutsideTheirBoundsIsRefused) {
  EXPECT_EQ(error_of("follow: {most: 0}"), "settings.yaml: follow.most: 0 is outside [1, 100]");
  EXPECT_EQ(error_of("follow: {most: -1}"), "settings.yaml: follow.most: -1 is outside [1, 100]");
  EXPECT_EQ(error_of("continuation: {mesh: {tolerance: 1}}"),
            "settings.yaml: continuation.mesh.tolerance: 1 rad is outside [1e-09, 0.01]");
  EXPECT_EQ(error_of("continuation: {mesh: {looser: 1}}"),
            "settings.yaml: continuation.mesh.looser: 1 is outside [1.1, 10]");
  EXPECT_EQ(error_of("fallbacks: {relaxed: [0.5, 1000]}"),
            "settings.yaml: fallbacks.relaxed[1]: 1000 is outside [0.01, 100]");
  EXPECT_EQ(error_of("race: {gaps: [{}, {width: 2}, {}]}"),
            "settings.yaml: race.gaps[1].width: 2 rad/s is outside [0, 1]");
  EXPECT_EQ(error_of("race: {last_gap: -1}"), "settings.yaml: race.last_gap: -1 is outside [0, .inf]");
}

TEST(SettingsFile, WithValuesOfAnotherKindIsRefused) {
  EXPECT_EQ(error_of("follow: {most: 2.5}"), "settings.yaml: follow.most: 2.5 is not a whole number from 1 to 100");
  EXPECT_EQ(error_of("follow: {most: many}"), "settings.yaml: follow.most: \"many\" is not a finite number");
  EXPECT_EQ(error_of("follow: {most: '3'}"), "settings.yaml: follow.most: must be a number, not the text \"3\"");
  EXPECT_EQ(error_of("follow: {long_motion: .inf}"),
            "settings.yaml: follow.long_motion: \".inf\" is not a finite number (s)");
  EXPECT_EQ(error_of("publication: 3"),
            "settings.yaml: publication: must be a map with the keys rounds, finer_rows, "
            "rounds_by_accuracy, shorter_rests, not the number 3");
  EXPECT_EQ(error_of("fallbacks: {relaxed: [1, 2, 3]}"),
            "settings.yaml: fallbacks.relaxed: must be a list of 2, not a list of 3");
  EXPECT_EQ(error_of("fallbacks: {relaxed: 0.5}"),
            "settings.yaml: fallbacks.relaxed: must be a list of 2, not the number 0.5");
  EXPECT_THAT(error_of("[]"), StartsWith("settings.yaml: must be a map with the keys continuation, starts, "));
}

TEST(SettingsFile, ThatContradictsItselfOrADefaultIsRefused) {
  EXPECT_EQ(error_of("continuation: {first: {most_intervals: 10}}"),
            "settings.yaml: continuation.first.fewest_intervals: 25 is above continuation.first.most_intervals, which "
            "is 10");
  EXPECT_EQ(error_of("race: {gaps: [{width: 0.01}, {}, {}]}"),
            "settings.yaml: race.gaps[1].width: 0.01 is not below race.gaps[0].width, which is 0.01");
  EXPECT_EQ(error_of("stepwise: {first_step: 1e-4}"),
            "settings.yaml: stepwise.shortest_step: 0.0002 is above stepwise.first_step, which is 0.0001");
  EXPECT_EQ(error_of("stepwise: {sharpest_width_factor: 0.2}"),
            "settings.yaml: stepwise.sharpest_width_factor: 0.2 is above stepwise.sharp_width_factor, which is 0.1");
  EXPECT_EQ(error_of("swing_up: {swing: 3}"),
            "settings.yaml: swing_up.swing: 3 is not below swing_up.durations[0], which is 2.3");
  EXPECT_EQ(error_of("tracking: {least_stiffness: 2}"),
            "settings.yaml: tracking.least_stiffness: 2 is above tracking.first_stiffness, which is 1");
  EXPECT_EQ(error_of("tracking: {most_stiffness: 0.5}"),
            "settings.yaml: tracking.first_stiffness: 1 is above tracking.most_stiffness, which is 0.5");
  EXPECT_EQ(error_of("tracking: {distrusted: 0.8}"),
            "settings.yaml: tracking.distrusted: 0.8 is above tracking.trusted, which is 0.75");
  EXPECT_EQ(error_of("slack: {most: 0.5}"),
            "settings.yaml: explanation.large_change: 1 is above slack.most, which is 0.5");
  EXPECT_EQ(error_of("budget: {refining: 0.4}"),
            "settings.yaml: budget.finding: 0.5 is above budget.refining, which is 0.4");
}

TEST(SettingsFile, WhoseTextIsDamagedIsReadWithinBoundsOrRefused) {
  const std::vector<std::string> valid{
      settings_yaml({}), "continuation: {mesh: {tolerance: 1e-6, most_intervals: 900}, warm: {iterations: 90}}\n",
      "race:\n  gaps:\n    - {width: 0.02, distance: .inf}\n    - width: 0.01\n    - {}\n  last_gap: 0.01\n",
      "fallbacks: {relaxed: [0.5, 3]}\nswing_up:\n  durations: [2, 3, 4]\n  swing: 1.2\nbudget: {damping: 2}\n"};
  std::mt19937 random(5);
  int accepted = 0, refused = 0;
  for (std::size_t i = 0; i < 2000; ++i) {
    const std::string text = mutated(valid[i < 200 ? 0 : 1 + i % (valid.size() - 1)], random);
    try {
      const SearchSettings settings = read(text);
      visit_numbers(settings, [&](const std::string& path, const SettingKey& key, const auto& number) {
        EXPECT_TRUE(static_cast<double>(number) >= key.least && static_cast<double>(number) <= key.most) << path;
      });
      ++accepted;
    } catch (const InputError& error) {
      EXPECT_FALSE(error.problem().empty());
      ++refused;
    } catch (const std::exception& error) {
      FAIL() << "round " << i << ": " << error.what() << "\n" << text;
    }
    ASSERT_FALSE(HasFailure()) << "round " << i << "\n" << text;
  }
  EXPECT_GT(accepted, 50);
  EXPECT_GT(refused, 500);
}

// ---- what they do ----

TEST(SettingsFile, ChangesThePlanWhichTellsSo) {
  const Problem problem = request("{start: {q: [0, 0]}, goal: {q: [0.3, -0.2]}}");
  PlanOptions options;
  options.search = read("continuation: {first: {fewest_intervals: 60}}");
  const Plan usual = plan(problem, {}), other = plan(problem, options);
  ASSERT_FALSE(usual.stages.empty() || other.stages.empty());
  EXPECT_EQ(usual.stages.front().intervals, 25);
  EXPECT_EQ(other.stages.front().intervals, 60);
  EXPECT_EQ(other.status, PlanStatus::kCertified);
  EXPECT_FALSE(plan_json(problem, usual).contains("settings"));
  EXPECT_EQ(plan_json(problem, other)["settings"], (Json{{"continuation.first.fewest_intervals", 60}}));
}

}  // namespace
}  // namespace fjr
