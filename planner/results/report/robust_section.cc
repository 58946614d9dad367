#include "planner/results/report/robust_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/results/report/html_table.h"
#include "planner/results/report/objective_text.h"

namespace fjr {
namespace {

constexpr std::size_t kDearest = 5;  // number of parameters shown, the most costly first

// Returns nothing if the plan has no such section or an empty one.
std::optional<JsonField> robustness_of(const JsonField& plan) {
  const auto certificate = plan.find("certificate");
  if (!certificate || certificate->is_null()) return std::nullopt;
  const auto robustness = certificate->find("robustness");
  return robustness && !robustness->is_null() ? robustness : std::nullopt;
}

int joint_of(const JsonField& margin, const char* key) {
  const JsonField joint = margin.at(key);
  return joint.is_null() ? 0 : static_cast<int>(joint.number());
}

// key: of the joint or link of a margin; before: what stands before its number.
void add_margin_rows(const JsonField& margins, const char* key, const char* before, Rows& rows) {
  for (const JsonField& m : margins.items()) {
    const int joint = joint_of(m, key);
    const std::string of = joint == 0 ? "" : fmt::format("{} {}", before, joint);
    const std::string parameter = m.at("parameter").text();
    rows.push_back({cell(spaced(m.at("name").text()) + of), cell(m.at("unit").text()),
                    cell(number_text(m.at("needed").number(), 3), m.at("passed").flag() ? "" : "over"),
                    cell(number_text(m.at("there").number(), 3)), cell(fmt::format("{:.4f} s", m.at("time").number())),
                    cell(parameter.empty() ? "encoder counts and ticks" : parameter),
                    cell(parameter.empty() ? "" : fmt::format("{:.0f} %", 100 * m.at("fraction").number()))});
  }
}

std::string promise(const JsonField& r) {
  const Joints<double> counts = r.at("link_error_counts").pair();
  const bool kept = r.at("verdict").text() == "kept";
  return fmt::format(
      "{} With a probability of {} over the {} parameters that are uncertain, links stay within {} and {} counts of "
      "the plan{}: the tubes in the charts, with the executor's feedback. Found with arms drawn from the parameters' "
      "covariance, {:.0f} % certain. Torques are held against what the drives can give. Not covered: {}.",
      kept ? "Kept." : "Lacking.", number_text(r.at("confidence").number()), number_text(r.at("parameters").number()),
      number_text(counts[0], 3), number_text(counts[1], 3), kept ? " and no limit is exceeded" : "",
      100 * r.at("certainty").number(), r.at("not_covered").text());
}

void add_savings(ChartPage& page, const JsonField& plan, const JsonField& robustness) {
  const double price = robustness.at("price").number();
  if (!std::isfinite(price)) return;
  const Gain gain = Gain::of(weighted_terms(plan));
  page.add_paragraph(fmt::format("The margins cost {} {}.", gain.saved(price), gain.unit));
  Rows rows{{cell("known twice as well"), cell(fmt::format("would give back ({})", gain.unit))}};
  for (const JsonField& saving : robustness.at("saved_by_halved_error").items()) {
    if (rows.size() > kDearest || !(saving.at("objective").number() > 0)) break;
    rows.push_back({cell(saving.at("parameter").text()), cell(gain.saved(saving.at("objective").number()))});
  }
  if (rows.size() > 1) page.add_html(html_table(rows));
}

}  // namespace

const std::vector<double>* Tubes::find(const std::string& name, int joint) const {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Tube& t) { return t.name == name && t.joint == joint; });
  return found == all.end() ? nullptr : &found->half;
}

std::optional<Tubes> read_tubes(const JsonField& plan) {
  const auto robustness = robustness_of(plan);
  if (!robustness) return std::nullopt;
  Tubes tubes{robustness->at("times").numbers(), {}};
  for (const JsonField& m : robustness->at("limits").items()) {
    tubes.all.push_back({m.at("name").text(), joint_of(m, "joint"), m.at("tube").numbers()});
  }
  int link = 0;
  for (const JsonField& half : robustness->at("link_tubes_rad").items()) {
    tubes.all.push_back({"link", ++link, half.numbers()});
  }
  return tubes;
}

void add_robustness(ChartPage& page, const JsonField& plan) {
  const auto r = robustness_of(plan);
  if (!r) return;
  page.add_heading("Other arms");
  page.add_paragraph(promise(*r));
  if (const std::string reason = r->at("reason").text(); !reason.empty()) page.add_paragraph(reason, "warning");
  Rows rows{{cell("margin"), cell("unit"), cell("needed"), cell("there"), cell("at"), cell("mostly for"),
             cell("of its square")}};
  add_margin_rows(r->at("limits"), "joint", "", rows);
  add_margin_rows(r->at("task"), "link", ", link", rows);
  page.add_html(html_table(rows));
  add_savings(page, plan, *r);
}

}  // namespace fjr
