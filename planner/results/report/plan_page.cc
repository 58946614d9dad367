#include "planner/results/report/plan_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <set>
#include <tuple>
#include <vector>

#include "common/chart_page.h"
#include "planner/plan.h"
#include "planner/problem/objective_terms.h"
#include "planner/problem/quantities.h"
#include "planner/results/json_field.h"
#include "planner/results/report/comparison_section.h"
#include "planner/results/report/html_table.h"
#include "planner/results/report/motion_section.h"
#include "planner/results/report/objective_text.h"
#include "planner/results/report/plan_limits.h"
#include "planner/results/report/plan_page_text.h"
#include "planner/results/report/proof_section.h"
#include "planner/results/report/repetition_section.h"
#include "planner/results/report/robust_section.h"
#include "planner/results/report/scene.h"
#include "planner/results/report/sensitivity_section.h"
#include "planner/results/report/time_charts.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

std::string with_joint(const std::string& name, int joint) {
  return joint == 0 ? spaced(name) : fmt::format("{} {}", spaced(name), joint);
}

void add_verdict(ChartPage& page, const JsonField& plan) {
  const std::string status = plan.at("status").text(), reason = plan.at("reason").text();
  if (const auto repetition = plan.find("repetition")) {
    page.add_paragraph(fmt::format("learnt: repetition {:.0f}; status and certificate are of the plan before",
                                   repetition->at("number").number()),
                       "warning");
  }
  page.add_html(fmt::format("<p><span class='badge {}'>{}</span>",
                            plan_status(status) == PlanStatus::kCertified ? "good" : "bad",
                            escaped_html(spaced(status))));
  const double duration = plan.at("duration").number();
  if (std::isfinite(duration)) {
    const std::vector<WeightedTerm> terms = weighted_terms(plan);
    page.add_html(fmt::format(" <b>{:.6g} s</b>, objective <b>{} {}</b> ({})", duration,
                              number_text(plan.at("objective").at("total").number(), 6),
                              escaped_html(objective_unit(terms)), escaped_html(objective_formula(terms))));
  }
  page.add_html("</p>\n");
  if (!reason.empty()) page.add_paragraph(reason, "warning");
}

Cell time_button(double time) {
  return html_cell(fmt::format("<button class='at' data-time='{0:.6f}'>{0:.4f} s</button>", time));
}

Cell bar(double percent, const std::string& css) {
  return html_cell(
      fmt::format("<span class='bar {}'><i style='width:{:.1f}%'></i></span>", css, std::clamp(percent, 0.0, 100.0)));
}

// Adds the middles of the ranges from which positions of the links are measured, if they are not zero.
void add_middles(ChartPage& page, const Parameters& robot) {
  std::string ranges;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double middle = robot.limits.link_middle[j];
    if (middle == 0) continue;
    ranges += fmt::format("{}link position {} is counted from {:.4g} rad, the middle of {:.4g} to {:.4g}",
                          ranges.empty() ? "" : "; ", j + 1, middle, robot.lowest(j), robot.highest(j));
  }
  if (!ranges.empty()) page.add_paragraph(ranges + ".", "note");
}

void add_margins(ChartPage& page, const std::vector<ReachedLimit>& limits, const Parameters& robot) {
  page.add_heading("Margins");
  Rows rows{{cell("limit"), cell("allowed"), cell("reached"), cell("unit"), cell(""), cell("share"), cell("margin"),
             cell("at"), cell("closed-loop rollout")}};
  for (const ReachedLimit& l : limits) {
    const double fraction = l.limit > 0 && std::isfinite(l.limit) ? 100 * l.reached / l.limit : 0;
    const std::string css = l.passed ? "" : "over";
    rows.push_back({cell(with_joint(l.name, l.joint)), cell(number_text(l.limit)), cell(number_text(l.reached, 6), css),
                    cell(std::string(unit_of_limit(l.name))), bar(fraction, css),
                    cell(fmt::format("{:.1f} %", fraction)), cell(number_text(l.limit - l.reached, 3)),
                    time_button(l.time), cell(number_text(l.rollout, 6))});
  }
  page.add_html(html_table(rows));
  add_middles(page, robot);
}

// Adds the margins to the task constraints.
void add_task_margins(ChartPage& page, const JsonField& checks) {
  Rows rows{{cell("on the way"), cell("clearance"), cell("unit"), cell("at")}};
  for (const JsonField& check : checks.items()) {
    const JsonField link = check.at("link");
    const std::string of_link = link.is_null() ? "" : fmt::format(", link {}", number_text(link.number()));
    rows.push_back({cell(spaced(check.at("name").text()) + of_link),
                    cell(number_text(check.at("room").number()), check.at("passed").flag() ? "" : "over"),
                    cell(check.at("unit").text()), time_button(check.at("time").number())});
  }
  if (rows.size() > 1) page.add_html(html_table(rows));
}

std::vector<Cell> rollout_row(const std::string& name, const JsonField& loop, double tolerance) {
  const double link = loop.at("max_link_error_rad").number(), at_end = loop.at("final_link_error_rad").number();
  const bool required = loop.at("required").flag();
  return {cell(name),
          cell(number_text(link, 3), required && !(link <= tolerance) ? "over" : ""),
          cell(number_text(link / tolerance, 3)),
          cell(number_text(loop.at("time_of_max_link_error").number())),
          cell(number_text(at_end, 3)),
          cell(number_text(loop.at("max_motor_error_rad").number(), 3)),
          cell(required ? "yes" : "no")};
}

void add_after_and_on_hardware(ChartPage& page, const JsonField& certificate) {
  const auto both = [](const JsonField& values) {
    const Joints<double> pair = values.pair();
    return fmt::format("{} and {}", number_text(pair[0], 3), number_text(pair[1], 3));
  };
  Rows rows{{cell("feedback torque in the closed loop (N m)"),
             cell(both(certificate.at("closed_loop").at("max_feedback_torque")))}};
  if (const JsonField residual = certificate.at("residual"); !residual.is_null()) {
    rows.push_back({cell(fmt::format("links from the goal within {} s after the end (rad)",
                                     number_text(residual.at("window").number()))),
                    cell(both(residual.at("link_vibration_rad")))});
    rows.push_back({cell("the same without feedback (rad)"), cell(both(residual.at("open_loop_drift_rad")))});
  }
  const JsonField tracking = certificate.at("tracking");
  rows.push_back({cell("predicted on hardware: link error (rad)"), cell(both(tracking.at("link_error_rad")))});
  rows.push_back({cell("predicted on hardware: peak torque (N m)"), cell(both(tracking.at("peak_torque")))});
  page.add_html(html_table(rows, false));
}

void add_certificate(ChartPage& page, const JsonField& certificate) {
  page.add_heading("Certificate");
  const double tolerance = certificate.at("tolerance_rad").number();
  page.add_paragraph(fmt::format(
      "{}: the published rows rolled out on the exact model by an independent integrator. Allowed is one count of the "
      "link encoder, {} rad.",
      certificate.at("verdict").text() == "certified" ? "Certified" : "Failed", number_text(tolerance, 4)));
  for (const JsonField& failure : certificate.at("failures").items()) page.add_paragraph(failure.text(), "warning");
  const JsonField open = certificate.at("open_loop"), closed = certificate.at("closed_loop");
  page.add_html(html_table({{cell("rollout"), cell("link error (rad)"), cell("counts"), cell("at (s)"),
                             cell("link error at the end (rad)"), cell("motor error (rad)"), cell("required")},
                            rollout_row("open loop", open, tolerance),
                            rollout_row("closed loop", closed, tolerance)}));
  if (const std::string why_not = open.at("reason").text(); !why_not.empty()) {
    page.add_paragraph("Open loop in several runs: " + why_not, "note");
  }
  add_after_and_on_hardware(page, certificate);
}

void add_mesh(ChartPage& page, const JsonField& mesh) {
  page.add_heading("Mesh and error");
  const std::vector<double> nodes = mesh.at("node_times").numbers();
  const std::vector<double> errors = mesh.at("errors").numbers();
  if (nodes.size() != errors.size() + 1) mesh.fail("must have one more of node_times than of errors");
  page.add_paragraph(fmt::format("{} intervals, {}; local error of an interval at most {} rad.", errors.size(),
                                 mesh.at("method").text(), number_text(mesh.at("error_estimate").number(), 3)));
  Chart error = time_chart("Local error of the intervals", "rad"), length = time_chart("Length of the intervals", "ms");
  error.logarithmic_y = length.logarithmic_y = true;
  Series bars{"error", "#555", Style::kLine, {}, {}}, dots{"nodes", "#1f77b4", Style::kDots, {}, {}},
      lengths{"length", "#555", Style::kLine, {}, {}};
  for (std::size_t k = 0; k < errors.size(); ++k) {
    for (const double time : {nodes[k], nodes[k + 1]}) {
      bars.x.push_back(time);
      bars.y.push_back(errors[k]);
      lengths.x.push_back(time);
      lengths.y.push_back(1e3 * (nodes[k + 1] - nodes[k]));
    }
    dots.x.push_back(nodes[k]);
    dots.y.push_back(errors[k]);
  }
  error.series = {dots, bars};
  length.series = {lengths};
  page.add_charts({error, length});
}

std::string in_brackets(const std::string& unit) { return unit.empty() ? "" : " (" + unit + ")"; }

void add_solver(ChartPage& page, const JsonField& solver, const std::vector<WeightedTerm>& objective) {
  page.add_heading("Solver");
  page.add_paragraph(fmt::format(
      "Iterations: {}. Starts: {}. Distinct minima: {}.{}", number_text(solver.at("iterations").number(), 9),
      number_text(solver.at("starts").number(), 9), number_text(solver.at("distinct_minima").number(), 9),
      solver.at("warm").flag() ? " Begun with an earlier plan's solution." : ""));
  Rows rows{{cell("stage"), cell("intervals"), cell("iterations"), cell("cost"), cell("outcome")}};
  Series objectives{"stages", "#1f77b4", Style::kRings, {}, {}};
  double iterations = 0;
  for (const JsonField& stage : solver.at("stages").items()) {
    const double own = stage.at("iterations").number(), cost = stage.at("objective").number();
    iterations += own;
    rows.push_back({cell(stage.at("name").text()), cell(number_text(stage.at("intervals").number(), 9)),
                    cell(number_text(own, 9)), cell(number_text(cost, 7)), cell(stage.at("status").text())});
    objectives.x.push_back(iterations);
    objectives.y.push_back(cost);
  }
  page.add_html(fmt::format("<details><summary>The {} stages of it</summary>", rows.size() - 1));
  page.add_paragraph("cost: what the stage minimised, which is " + objective_formula(objective) +
                         " unless it was about something else, such as a slack; with its regularisation.",
                     "note");
  page.add_html(html_table(rows) + "</details>\n");
  if (objectives.x.size() > 1) {
    page.add_html("<div class='pairs'>");
    page.add_charts({{"Cost at the end of each stage",
                      "iterations",
                      fmt::format("{}{}", objective_formula(objective), in_brackets(objective_unit(objective))),
                      {objectives}}});
    page.add_html("</div>\n");
  }
}

// Returns null for a term of another version.
const TermInfo* term_of(std::string_view name) {
  const auto found =
      std::find_if(Terms::infos.begin(), Terms::infos.end(), [&](const TermInfo& term) { return term.name == name; });
  return found == Terms::infos.end() ? nullptr : &*found;
}

void add_objective(ChartPage& page, const JsonField& plan) {
  page.add_heading("Objective");
  const JsonField terms = plan.at("objective").at("terms"), weights = plan.at("resolved_request").at("objective");
  Rows rows{{cell("term"), cell("value"), cell("weight"), cell("unit")}};
  for (const auto& term : terms.json().items()) {
    const auto weight = weights.find(term.key());
    const TermInfo* const info = term_of(term.key());
    const double sign = info != nullptr && info->reward ? -1 : 1;
    rows.push_back({cell(spaced(term.key())), cell(number_text(terms.at(term.key()).number(), 6)),
                    cell(weight && weight->number() != 0 ? number_text(sign * weight->number()) : ""),
                    cell(info != nullptr ? info->unit : "")});
  }
  page.add_html(html_table(rows));
  const std::vector<WeightedTerm> weighted = weighted_terms(plan);
  const std::string unit = objective_unit(weighted);
  page.add_paragraph(fmt::format("Minimised: {} = {}{}{}", objective_formula(weighted),
                                 number_text(plan.at("objective").at("total").number(), 7), unit.empty() ? "" : " ",
                                 unit));
}

void add_request(ChartPage& page, const JsonField& plan) {
  page.add_heading("Request");
  page.add_paragraph("As it was understood, with everything resolved; - is free.", "note");
  page.add_html(html_of_json(plan.at("resolved_request").json()));
  page.add_html("<details><summary>The robot it was planned for</summary>" + html_of_json(plan.at("robot").json()) +
                "</details>\n");
}

void add_infeasibility(ChartPage& page, const JsonField& why) {
  if (why.is_null()) return;
  page.add_heading("Why not, and what would have to change");
  page.add_paragraph("Each of the relaxations alone makes the request feasible.", "note");
  page.add_html(html_of_json(why.json()));
}

// Plots H, which should be constant between via points, as a line if the columns `along` exist.
void add_optimality(ChartPage& page, const JsonField& optimality) {
  page.add_heading("Optimality");
  const auto along = optimality.find("along");
  Json rest = optimality.json();
  rest.erase("along");
  page.add_html(html_of_json(rest));
  if (!along || along->at("time").items().empty()) return;
  const std::vector<double> time = along->at("time").numbers();
  const auto line = [&](const JsonField& from, const std::string& name, const char* colour) {
    std::vector<double> values = from.at(name).numbers();
    if (values.size() != time.size()) from.at(name).fail(fmt::format("must have {} numbers, as time has", time.size()));
    return Series{name, colour, Style::kLine, time, std::move(values)};
  };
  Chart h = time_chart("Hamiltonian", "");
  h.series = {line(*along, "hamiltonian", "#555")};
  const JsonField costate = along->at("costate");
  Chart positions = time_chart("Costates of the positions", "per rad");
  Chart velocities = time_chart("Costates of the velocities", "per rad/s");
  for (const auto& [chart, link, motor] : {std::tuple{&positions, "q", "theta"}, {&velocities, "dq", "dtheta"}}) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      chart->series.push_back(line(costate, fmt::format("{}{}", link, j + 1), kJointColour[j]));
      chart->series.push_back(line(costate, fmt::format("{}{}", motor, j + 1), kMotorColour[j]));
    }
  }
  page.add_charts({h, positions, velocities});
}

void add_what_else_there_is(ChartPage& page, const Json& plan) {
  static const std::set<std::string> shown{
      "version",  "request",     "status",           "reason",        "objective",  "duration",     "mesh",
      "solver",   "certificate", "resolved_request", "robot",         "robot_hash", "request_hash", "via_times",
      "back_off", "timing",      "sensitivity",      "infeasibility", "optimality", "repetition"};
  for (const auto& section : plan.items()) {
    if (shown.count(section.key()) > 0 || section.value().is_null()) continue;
    std::string title = spaced(section.key());
    title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
    page.add_heading(title);
    page.add_html(html_of_json(section.value()));
  }
}

void add_origin(ChartPage& page, const JsonField& plan) {
  page.add_paragraph(fmt::format("fjr {}; request_hash {}; robot_hash {}", plan.at("version").text(),
                                 plan.at("request_hash").text(), plan.at("robot_hash").text()),
                     "note");
}

}  // namespace

std::string plan_page(const PlanRecord& record) {
  const JsonField plan(record.plan, record.source);
  ChartPage page("Plan: " + plan.at("request").text());
  page.add_style(kPlanPageStyle);
  add_verdict(page, plan);
  const std::vector<ReachedLimit> limits = read_limits(plan);
  const Json scene = scene_json(plan, record.robot);
  if (record.trajectory) {
    const std::vector<ComparedMotion> motions = compared_motions(record.robot, *record.trajectory);
    add_motion(page, record, scene, limits, motions);
    add_repetition(page, plan, record.robot);
    add_margins(page, limits, record.robot);
    add_task_margins(page, plan.at("certificate").at("task"));
    add_certificate(page, plan.at("certificate"));
    add_proof(page, plan.at("certificate"));
    add_robustness(page, plan);
    add_comparison(page, record.robot, motions, *record.trajectory, weighted_terms(plan), limits, !scene.empty());
    add_mesh(page, plan.at("mesh"));
    add_objective(page, plan);
    if (!plan.at("sensitivity").is_null()) add_sensitivity(page, plan);
  }
  if (!record.trajectory) add_poses(page, record.robot, plan, scene);
  if (const auto why = plan.find("infeasibility")) add_infeasibility(page, *why);
  add_solver(page, plan.at("solver"), weighted_terms(plan));
  if (const auto found = plan.find("optimality"); found && !found->is_null()) add_optimality(page, *found);
  add_what_else_there_is(page, record.plan);
  add_request(page, plan);
  add_origin(page, plan);
  return page.html();
}

}  // namespace fjr
