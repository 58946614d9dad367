// A plan.json in which anything is missing or of another kind is refused, or shown without it: nothing else becomes of
// reports and exports.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "common/bounded_json.h"
#include "common/input_error.h"
#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/results/export/formats.h"
#include "planner/results/plan_json.h"
#include "planner/results/report/plan_page.h"
#include "planner/results/strict_json.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;
using Pointer = Json::json_pointer;

// Of all values within it; of long lists the first two items. here: a copy, for `places` may have to move what it has.
void add_places(const Json& json, Pointer here, std::vector<Pointer>& places) {
  if (json.is_object()) {
    for (const auto& item : json.items()) {
      places.push_back(here / item.key());
      add_places(item.value(), places.back(), places);
    }
  }
  for (std::size_t i = 0; json.is_array() && i < std::min<std::size_t>(json.size(), 2); ++i) {
    places.push_back(here / i);
    add_places(json[i], places.back(), places);
  }
}

// False: it was refused.
template <class Use>
bool used(const Json& plan, const Trajectory& rows, const Use& use) {
  try {
    const PlanRecord record = record_of(plan, "plan.json", rows);
    reading("plan.json", [&] { use(record); });
    return true;
  } catch (const InputError& refused) {
    EXPECT_THAT(refused.what(), testing::StartsWith("plan.json"));
    return false;
  }
}

// Readers call themselves for what is nested: 100,000 levels took all of the stack.
TEST(DamagedPlan, IsRefusedWhereItIsNestedTooDeeply) {
  const auto nested = [](std::size_t levels) {
    return "{\"status\": " + std::string(levels, '[') + std::string(levels, ']') + "}";
  };
  EXPECT_NO_THROW(parse_json(nested(20), "plan.json"));
  EXPECT_FALSE(json_from_text<Json>(nested(20)).is_discarded());
  for (const std::size_t levels : {kDeepestJson, std::size_t{1'000'000}}) {
    EXPECT_THROW(parse_json(nested(levels), "plan.json"), InputError) << levels;
    EXPECT_TRUE(json_from_text<Json>(nested(levels)).is_discarded()) << levels;
  }
  EXPECT_EQ(json_from_cbor<Json>("\x81\x82\x01\x02"), Json::parse("[[1, 2]]"));
  EXPECT_THROW(json_from_cbor<Json>(std::string(1'000'000, '\x81')), std::invalid_argument);
  EXPECT_THROW(json_from_cbor<Json>("\x82\x01"), std::invalid_argument);
  EXPECT_EQ(json_from_cbor<Json>("\x82\x7f\x61\x61\x61\x62\xff\x7f\x61\x63\xff"), Json::parse(R"(["ab", "c"])"));
  EXPECT_EQ(json_from_cbor<Json>("\x62\x7f\x7f"), Json("\x7f\x7f"));
  EXPECT_THROW(json_from_cbor<Json>(std::string(1'000'000, '\x7f')), std::invalid_argument);
  EXPECT_THROW(json_from_cbor<Json>(std::string(1'000'000, '\x5f')), std::invalid_argument);
}

TEST(DamagedPlan, IsRefusedOrShownWithoutIt) {
  const Problem problem = parse_request(
      "start: {q: [0.3, 0.2]}\ngoal: {q: [0.36, 0.14]}\nobstacles: [{center: [0.3, 0.3], radius: 0.05}]\n"
      "walls: [{point: [-0.5, 0], normal: [1, 0]}]\nvia: [{q: [0.33, 0.17]}]\nlimits: {tip_speed: 1}\n",
      "request.yaml", {}, default_robot_file());
  const Plan planned = plan(problem, {});
  ASSERT_TRUE(planned.trajectory);
  const Json whole = plan_json(problem, planned);
  const auto report = [](const PlanRecord& record) { (void)plan_page(record); };
  const auto tables = [](const PlanRecord& record) {
    Exported exported;
    exported.plan = &record;
    exported.ticked = at_ticks(record.robot, *record.trajectory, 0.001);
    (void)as_mcap(exported);
  };
  ASSERT_TRUE(used(whole, *planned.trajectory, report));
  ASSERT_TRUE(used(whole, *planned.trajectory, tables));
  std::vector<Pointer> places;
  add_places(whole, Pointer(), places);
  ASSERT_GT(places.size(), 300u);
  std::size_t refused = 0;
  const auto expect_no_worse = [&](const Json& damaged) {
    refused += !used(damaged, *planned.trajectory, report);
    refused += !used(damaged, *planned.trajectory, tables);
  };
  const auto replaced = [&](const Pointer& place, const Json& by) {
    SCOPED_TRACE(place.to_string() + ": " + by.dump());
    Json damaged = whole;
    damaged[place] = by;
    expect_no_worse(damaged);
  };
  // Lists that were read without asking how long they are, and what was taken for an object.
  for (const char* list : {"/optimality/along/hamiltonian", "/optimality/along/costate/q1", "/via_times",
                           "/resolved_request/limits/torque", "/resolved_request/obstacles", "/mesh/errors"}) {
    replaced(Pointer(list), Json::array());
  }
  replaced(Pointer("/optimality"), "text");
  const std::vector<Json> others = {nullptr, Json::array(), Json::object(), "text", -1e300, true, {1, {}}};
  std::mt19937 random(16);
  constexpr int kTried = 24;
  for (int i = 0; i < kTried; ++i) {
    const Pointer& place = places[random() % places.size()];
    replaced(place, others[static_cast<std::size_t>(i) % others.size()]);
    Json without = whole;
    Json& parent = without[place.parent_pointer()];
    if (parent.is_object()) parent.erase(place.back());
    SCOPED_TRACE("without " + place.to_string());
    expect_no_worse(without);
  }
  EXPECT_GT(refused, kTried / 4);
}

}  // namespace
}  // namespace fjr
