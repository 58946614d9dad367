#include "planner/results/report/both_plans_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "common/chart_page.h"
#include "common/input_error.h"
#include "planner/results/report/html_table.h"
#include "planner/results/report/motion_section.h"
#include "planner/results/report/objective_text.h"
#include "planner/results/report/plan_limits.h"
#include "planner/results/report/plan_page_text.h"
#include "planner/results/report/scene.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;
using Both = std::array<JsonField, 2>;

// Returns the names of the two plans: those of their requests, with their folders if these are equal.
std::array<std::string, 2> names_of(const Both& plans, const PlanRecord& first, const PlanRecord& second) {
  std::array<std::string, 2> names{plans[0].at("request").text(), plans[1].at("request").text()};
  if (names[0] != names[1]) return names;
  const std::array<const PlanRecord*, 2> records{&first, &second};
  for (std::size_t i = 0; i < 2; ++i) {
    names[i] += fmt::format(" in {}", std::filesystem::path(records[i]->source).parent_path().string());
  }
  return names;
}

// Returns the objects to draw in the plane: those of the first plan, and further ones of the second.
Json scene_of_both(const Both& plans, const PlanRecord& first, const PlanRecord& second) {
  Json scene = scene_json(plans[0], first.robot);
  for (const Json& shape : scene_json(plans[1], second.robot)) {
    if (std::find(scene.begin(), scene.end(), shape) == scene.end()) scene.push_back(shape);
  }
  return scene;
}

// Adds a row with a value from each plan.
template <class Value>
void add_row(Rows& rows, const Both& plans, const std::string& label, const Value& value) {
  rows.push_back({cell(label), cell(value(plans[0])), cell(value(plans[1]))});
}

Rows figures_of_both(const Both& plans, const std::array<std::string, 2>& names) {
  Rows rows{{cell(""), cell(names[0]), cell(names[1])}};
  add_row(rows, plans, "status", [](const JsonField& p) { return spaced(p.at("status").text()); });
  add_row(rows, plans, "duration (s)", [](const JsonField& p) { return number_text(p.at("duration").number(), 6); });
  add_row(rows, plans, "minimised", [](const JsonField& p) { return objective_formula(weighted_terms(p)); });
  add_row(rows, plans, "objective", [](const JsonField& p) {
    return number_text(p.at("objective").at("total").number(), 6) + " " + objective_unit(weighted_terms(p));
  });
  for (const TermInfo& term : Terms::infos) {
    add_row(rows, plans, fmt::format("{} ({})", spaced(term.name), term.unit), [&](const JsonField& p) {
      const auto value = p.at("objective").at("terms").find(term.name);
      return value ? number_text(value->number(), 6) : "-";
    });
  }
  for (const char* loop : {"open_loop", "closed_loop"}) {
    add_row(rows, plans, spaced(loop) + ", largest link error (rad)", [&](const JsonField& p) {
      return number_text(p.at("certificate").at(loop).at("max_link_error_rad").number(), 3);
    });
  }
  add_row(rows, plans, "robot", [](const JsonField& p) { return p.at("robot_hash").text().substr(0, 12); });
  add_row(rows, plans, "request", [](const JsonField& p) { return p.at("request_hash").text().substr(0, 12); });
  return rows;
}

// Returns rows with the reached and the allowed value in each plan, for every limit that one of them has.
Rows limits_of_both(const Both& plans, const std::array<std::string, 2>& names) {
  const std::array<std::vector<ReachedLimit>, 2> limits{read_limits(plans[0]), read_limits(plans[1])};
  Rows rows{{cell("reached, of limit"), cell(names[0]), cell(names[1]), cell("unit")}};
  for (const LimitName& name : kLimitNames) {
    std::vector<Cell> row{
        cell(fmt::format("{}{}", spaced(name.quantity->name), name.joint == 0 ? "" : fmt::format(" {}", name.joint)))};
    bool any = false;
    for (const std::vector<ReachedLimit>& of_plan : limits) {
      const ReachedLimit* limit = find_limit(of_plan, name.quantity->name, name.joint);
      row.push_back(limit == nullptr ? cell("-")
                                     : cell(fmt::format("{} of {}, {:.1f} %", number_text(limit->reached),
                                                        number_text(limit->limit), 100 * limit->reached / limit->limit),
                                            limit->passed ? "" : "over"));
      any = any || limit != nullptr;
    }
    row.push_back(cell(name.quantity->unit));
    if (any) rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::string both_plans_page(const PlanRecord& first, const PlanRecord& second) {
  for (const PlanRecord* record : {&first, &second}) {
    if (!record->trajectory) throw InputError(record->source, "", "has no trajectory: there is nothing to lay over");
  }
  const Both plans{JsonField(first.plan, first.source), JsonField(second.plan, second.source)};
  const std::array<std::string, 2> names = names_of(plans, first, second);
  ChartPage page(fmt::format("Plans: {} and {}", names[0], names[1]));
  page.add_style(kPlanPageStyle);
  add_both_motions(page, {names[0], first}, {names[1], second}, scene_of_both(plans, first, second),
                   read_limits(plans[0]));
  page.add_heading("Side by side");
  page.add_html(html_table(figures_of_both(plans, names)));
  page.add_heading("Limits");
  page.add_html(html_table(limits_of_both(plans, names)));
  return page.html();
}

}  // namespace fjr
