#include "planner/results/report/comparison_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "planner/certificate/residual.h"
#include "planner/ocp/objective.h"
#include "planner/problem/quantities.h"
#include "planner/results/report/html_table.h"
#include "planner/results/report/time_charts.h"

namespace fjr {
namespace {

double commanded(const Sample& s, std::size_t j) { return s.torque[j]; }

Cell against_limit(double value, double limit) { return cell(number_text(value), value > limit * 1.005 ? "over" : ""); }

void add_peaks(Rows& rows, const std::vector<ComparedMotion>& motions, const std::vector<ReachedLimit>& limits,
               const QuantityInfo& quantity, const std::string& label) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    const ReachedLimit* limit = find_limit(limits, quantity.name, static_cast<int>(j + 1));
    const double allowed = limit == nullptr ? INFINITY : limit->limit;
    rows.push_back({cell(fmt::format("{} {}, at most ({})", label, j + 1, quantity.unit))});
    for (const ComparedMotion& m : motions) {
      rows.back().push_back(against_limit(quantity.in(m.run.figures.peaks, j), allowed));
    }
    rows.back().push_back(cell(number_text(allowed)));
  }
}

// Returns whether a term can be computed from the samples of a run. The torque rate cannot, since torques there jump
// from tick to tick, nor can terms of a release.
bool is_told_by_rows(const WeightedTerm& term, const std::map<std::string, double>& terms_of_run) {
  return terms_of_run.count(term.info->name) > 0;
}

// Adds rows with the terms of the objective for each run, until the end of the plan.
void add_objective_rows(Rows& rows, const Parameters& robot, const std::vector<ComparedMotion>& motions,
                        const std::vector<WeightedTerm>& objective, double end) {
  std::vector<std::map<std::string, double>> terms;
  for (const ComparedMotion& m : motions) {
    Trajectory until_end;
    for (const Sample& s : m.run.simulation.samples) {
      if (s.time <= end) until_end.samples.push_back(s);
    }
    terms.push_back(terms_of_rows(robot, until_end));
  }
  const auto add = [&](const std::string& label, const auto& value) {
    rows.push_back({cell(label)});
    for (const auto& of_run : terms) rows.back().push_back(cell(number_text(value(of_run), 5)));
    rows.back().push_back(cell(""));
  };
  const auto known = [&](const WeightedTerm& term) { return is_told_by_rows(term, terms.front()); };
  for (const WeightedTerm& term : objective) {
    if (!known(term)) continue;
    add(fmt::format("objective: {} ({})", spaced(term.info->name), term.info->unit),
        [&](const auto& of_run) { return of_run.at(term.info->name); });
  }
  if (objective.size() < 2 || !std::all_of(objective.begin(), objective.end(), known)) return;
  add("objective: " + objective_formula(objective), [&](const auto& of_run) {
    double sum = 0;
    for (const WeightedTerm& term : objective) sum += term.weight * of_run.at(term.info->name);
    return sum;
  });
}

Rows comparison_table(const Parameters& robot, const std::vector<ComparedMotion>& motions,
                      const std::vector<WeightedTerm>& objective, const std::vector<ReachedLimit>& limits, double end) {
  Rows rows(1);
  rows[0].push_back(cell(""));
  for (const ComparedMotion& m : motions) rows[0].push_back(cell(m.name));
  rows[0].push_back(cell("limit"));
  add_objective_rows(rows, robot, motions, objective, end);
  for (std::size_t j = 0; j < kJoints; ++j) {
    rows.push_back({cell(fmt::format("link {}, furthest from the goal after the end (rad)", j + 1))});
    for (const ComparedMotion& m : motions) rows.back().push_back(cell(number_text(m.run.figures.residual[j], 3)));
    rows.back().push_back(cell(""));
  }
  rows.push_back({cell(fmt::format("both links within {:g} rad of it after (s)", kSettled))});
  for (const ComparedMotion& m : motions) {
    rows.back().push_back(cell(std::isfinite(m.run.figures.settling_time)
                                   ? fmt::format("{:.3f}", m.run.figures.settling_time)
                                   : fmt::format("more than {:g}", kWatchedAfterEnd)));
  }
  rows.back().push_back(cell(""));
  add_peaks(rows, motions, limits, Torque::info, "torque");
  add_peaks(rows, motions, limits, SpringDeflection::info, "spring deflection");
  add_peaks(rows, motions, limits, MotorVelocity::info, "motor velocity");
  return rows;
}

// Returns a sentence about terms of the objective that are not in the table; empty if all are.
std::string about_what_is_missing(const Parameters& robot, const Trajectory& plan,
                                  const std::vector<WeightedTerm>& objective) {
  const std::map<std::string, double> told = terms_of_rows(robot, plan);
  std::string names;
  for (const WeightedTerm& term : objective) {
    if (!is_told_by_rows(term, told)) names += (names.empty() ? "" : ", ") + spaced(term.info->name);
  }
  if (names.empty()) return "";
  return fmt::format(
      "Not compared is what the plan was to do as to {}, nor the whole objective: in such runs torques jump from tick "
      "to tick, so that they have no rate, and nothing is let go.",
      names);
}

std::vector<Chart> comparison_charts(const std::vector<ComparedMotion>& motions, const Trajectory& plan,
                                     const std::vector<ReachedLimit>& limits) {
  std::vector<Chart> charts;
  const Sample& goal = plan.samples.back();
  for (std::size_t j = 0; j < kJoints; ++j) {
    Chart after = time_chart(fmt::format("Link {} after the end, from the goal", j + 1), "rad");
    for (const ComparedMotion& m : motions) {
      Series series{m.name, m.colour, Style::kLine, {}, {}};
      for (const Sample& s : m.run.simulation.samples) {
        if (s.time < goal.time) continue;
        series.x.push_back(s.time);
        series.y.push_back(s.state.q[j] - goal.state.q[j]);
      }
      after.series.push_back(std::move(series));
    }
    charts.push_back(std::move(after));
  }
  for (std::size_t j = 0; j < kJoints; ++j) {
    Chart needed = time_chart(fmt::format("Torque of motor {}", j + 1), "N m");
    for (const ComparedMotion& m : motions) {
      needed.series.push_back(series_of(m.name, m.colour, m.run.simulation.samples, commanded, j));
    }
    if (const ReachedLimit* limit = find_limit(limits, "torque", static_cast<int>(j + 1))) {
      needed.series.push_back(
          both_sides("limit", "#555", limit->limit, 0, motions.front().run.simulation.samples.back().time));
    }
    charts.push_back(std::move(needed));
  }
  return charts;
}

}  // namespace

std::vector<ComparedMotion> compared_motions(const Parameters& robot, const Trajectory& plan) {
  const Sample &first = plan.samples.front(), &last = plan.samples.back();
  if (!is_at_rest(robot, first) || !is_at_rest(robot, last)) return {};
  std::vector<ComparedMotion> motions{{"this plan", "#2a9d4a", run_on_elastic_arm(robot, plan)}};
  for (const auto& [profile, colour] :
       {std::pair{Profile::kMinimumJerk, "#8c56b5"}, {Profile::kTrapezoidal, "#c43c3c"}}) {
    const Trajectory reference =
        rigid_reference(robot, profile, first.state.q, last.state.q, plan.end_time() - plan.start_time());
    motions.push_back({name(profile), colour, run_on_elastic_arm(robot, reference)});
  }
  return motions;
}

void add_comparison(ChartPage& page, const Parameters& robot, const std::vector<ComparedMotion>& motions,
                    const Trajectory& plan, const std::vector<WeightedTerm>& objective,
                    const std::vector<ReachedLimit>& limits, bool with_scene) {
  page.add_heading("Had it been planned without the springs");
  if (motions.empty()) {
    page.add_paragraph(
        "There is no such comparison: this motion does not lead from rest to rest, and the profiles of a rigid arm "
        "that one would compare it with do.");
    return;
  }
  page.add_paragraph(fmt::format(
      "The same way from rest to rest in the same {:.4g} s by two profiles for rigid arms, on the same elastic arm: "
      "motors follow the profile by the executor's feedback, with the torque that a rigid arm would need, gravity and "
      "exact friction included, as feed-forward. The drive gives whatever is asked of it; red is above the limit.{}",
      plan.end_time() - plan.start_time(),
      with_scene ? " They go straight, whatever else the request asks for on the way." : ""));
  page.add_html(html_table(comparison_table(robot, motions, objective, limits, plan.end_time())));
  const std::string missing = about_what_is_missing(robot, plan, objective);
  if (!missing.empty()) page.add_paragraph(missing);
  for (const ComparedMotion& m : motions) {
    if (!m.run.simulation.failure.empty()) page.add_paragraph(m.name + ": " + m.run.simulation.failure, "warning");
  }
  page.add_html("<div class='pairs'>");
  page.add_charts(comparison_charts(motions, plan, limits));
  page.add_html("</div>\n");
}

}  // namespace fjr
