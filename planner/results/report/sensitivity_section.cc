#include "planner/results/report/sensitivity_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "planner/results/report/html_table.h"
#include "planner/results/report/objective_text.h"

namespace fjr {
namespace {

// Shows a sensitivity per thousandth of the unit, because a whole radian or second is far outside the linear range.
Cell per_thousandth(const Gain& gain, const std::string& unit_of_what, double objective) {
  return cell(fmt::format("{} per m{}", gain.saved(1e-3 * objective), unit_of_what));
}

// The change of a limit or duration for which prices are shown, as in the summary.
constexpr double kOnePercentMore = 0.01;

std::string stretches(const JsonField& active) {
  std::string text;
  for (const JsonField& stretch : active.items()) {
    const Joints<double> times = stretch.pair();
    text += fmt::format("{}{:.4f} to {:.4f}", text.empty() ? "" : ", ", times[0], times[1]);
  }
  return text;
}

// Adds the limits that are active anywhere, those with the highest price first.
void add_limits(ChartPage& page, const JsonField& all, const Gain& gain) {
  std::vector<JsonField> limits = all.items();
  std::erase_if(limits, [](const JsonField& l) { return l.at("active").items().empty(); });
  const auto cost = [](const JsonField& l) { return l.at("worth").number() * l.at("limit").number(); };
  std::stable_sort(limits.begin(), limits.end(),
                   [&](const JsonField& a, const JsonField& b) { return cost(a) > cost(b); });
  if (limits.empty()) return page.add_paragraph("No limit is active.");
  Rows rows{{cell("active limit"), cell("limit"), cell("1 % more"), cell(fmt::format("would save ({})", gain.unit)),
             cell("active"), cell("from when to when (s)", "long")}};
  for (const JsonField& l : limits) {
    const JsonField joint = l.at("joint");
    const std::string of = joint.is_null() ? "" : fmt::format(" {}", number_text(joint.number()));
    const double more = kOnePercentMore * l.at("limit").number();
    const std::string unit = l.at("unit").text();
    rows.push_back(
        {cell(spaced(l.at("name").text()) + of), cell(fmt::format("{} {}", number_text(l.at("limit").number()), unit)),
         cell(fmt::format("{} {}", number_text(more, 3), unit)), cell(gain.saved(more * l.at("worth").number())),
         cell(fmt::format("{:.0f} %", 100 * l.at("active_share").number())), cell(stretches(l.at("active")), "long")});
  }
  page.add_html(html_table(rows));
}

void add_pair(Rows& rows, const std::string& name, const JsonField& values, const Gain& gain, const char* unit) {
  if (values.is_null()) return;
  const Joints<double> pair = values.pair();
  for (std::size_t j = 0; j < kJoints; ++j) {
    rows.push_back({cell(fmt::format("{} {}", name, j + 1)), per_thousandth(gain, unit, pair[j])});
  }
}

// Adds the sensitivities to given values that are not limits: duration, via points, goal.
void add_givens(ChartPage& page, const JsonField& plan, const Gain& gain) {
  const JsonField sensitivity = plan.at("sensitivity");
  Rows rows{{cell("given"), cell(fmt::format("more costs ({})", gain.unit))}};
  if (const JsonField duration = sensitivity.at("duration"); !duration.is_null()) {
    const double more = kOnePercentMore * plan.at("duration").number();
    rows.push_back({cell("duration"), cell(fmt::format("{} for 1 %, {} ms", gain.saved(more * duration.number()),
                                                       number_text(1e3 * more, 3)))});
  }
  for (const JsonField& via : sensitivity.at("via").items()) {
    const std::string name = fmt::format("via at {} s: ", number_text(via.at("time").number()));
    add_pair(rows, name + "link", via.at("q"), gain, "rad");
    add_pair(rows, name + "velocity of link", via.at("dq"), gain, "rad/s");
    if (const JsonField later = via.at("later"); !later.is_null()) {
      rows.push_back({cell(name + "time"), per_thousandth(gain, "s", later.number())});
    }
  }
  add_pair(rows, "goal: link", sensitivity.at("goal").at("q"), gain, "rad");
  page.add_html(html_table(rows));
}

}  // namespace

void add_sensitivity(ChartPage& page, const JsonField& plan) {
  const JsonField sensitivity = plan.at("sensitivity");
  const Gain gain = Gain::of(weighted_terms(plan));
  page.add_heading("What limits the motion");
  page.add_paragraph(
      "By the multipliers, to first order, for 1 % of the limit. Of obstacles, walls, tip regions and paths for 1 % "
      "of the clearance or tolerance.",
      "note");
  add_limits(page, sensitivity.at("limits"), gain);
  add_givens(page, plan, gain);
}

}  // namespace fjr
