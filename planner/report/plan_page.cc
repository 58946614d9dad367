#include "planner/report/plan_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "model/chart_page.h"
#include "model/kinematics.h"
#include "planner/certificate/residual.h"
#include "planner/problem/units.h"
#include "planner/report/html_table.h"
#include "planner/report/json_field.h"
#include "planner/report/plan_page_text.h"
#include "planner/report/rigid_profile.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<Cell>>;

constexpr Pair<const char*> kColour{"#1f77b4", "#d9660f"}, kPale{"#8cbbdc", "#f2b183"};  // joints; their motors
constexpr std::size_t kMostSamples = 1500;                                               // of a motion in the animation
constexpr double kNear = 0.45;  // a limit is drawn when a curve comes this near to it

std::string number(double value, int digits = 4) {
  return std::isnan(value) ? "-" : std::isinf(value) ? "none" : fmt::format("{:.{}g}", value, digits);
}

Cell cell(std::string text, std::string css = "") { return {std::move(text), std::move(css), ""}; }
Cell html_cell(std::string html) { return {"", "", std::move(html)}; }

std::string with_joint(const std::string& name, int joint) {
  return joint == 0 ? spaced(name) : fmt::format("{} {}", spaced(name), joint);
}

// ---- the plan's limits ----

struct Limit {
  std::string name;
  int joint;  // 0: none
  double limit, reached, time, rollout;
  bool passed;
};

std::vector<Limit> read_limits(const JsonField& plan) {
  std::vector<Limit> limits;
  const JsonField certificate = plan.at("certificate");
  if (certificate.is_null()) return limits;
  for (const JsonField& item : certificate.at("limits").items()) {
    const JsonField joint = item.at("joint");
    limits.push_back({item.at("name").text(), joint.is_null() ? 0 : static_cast<int>(joint.number()),
                      item.at("limit").number(), item.at("reached").number(), item.at("time").number(),
                      item.at("rollout").number(), item.at("passed").flag()});
  }
  return limits;
}

const Limit* limit_of(const std::vector<Limit>& limits, const std::string& name, int joint) {
  const auto found =
      std::find_if(limits.begin(), limits.end(), [&](const Limit& l) { return l.name == name && l.joint == joint; });
  return found == limits.end() || !std::isfinite(found->limit) ? nullptr : &*found;
}

// ---- charts over time ----

using Quantity = double (*)(const Sample& sample, std::size_t joint);

double link(const Sample& s, std::size_t j) { return s.state.q[j]; }
double motor(const Sample& s, std::size_t j) { return s.state.theta[j]; }
double link_velocity(const Sample& s, std::size_t j) { return s.state.dq[j]; }
double motor_velocity(const Sample& s, std::size_t j) { return s.state.dtheta[j]; }
double deflection(const Sample& s, std::size_t j) { return s.state.theta[j] - s.state.q[j]; }
double torque(const Sample& s, std::size_t j) { return s.torque[j]; }

Series series_of(const std::string& name, const char* colour, const std::vector<Sample>& samples, Quantity quantity,
                 std::size_t joint, Style style = Style::kLine) {
  Series series{name, colour, style, {}, {}};
  for (const Sample& sample : samples) {
    series.x.push_back(sample.time);
    series.y.push_back(quantity(sample, joint));
  }
  return series;
}

Chart time_chart(const std::string& title, const std::string& unit) {
  Chart chart{title, "time (s)", unit, {}};
  chart.time_axis = true;
  return chart;
}

void add_joints(Chart& chart, const std::vector<Sample>& samples, const std::string& what, Quantity quantity,
                const Pair<const char*>& colours, Style style = Style::kLine) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    chart.series.push_back(series_of(fmt::format("{} {}", what, j + 1), colours[j], samples, quantity, j, style));
  }
}

Series both_sides(const std::string& name, const char* colour, double limit, double from, double to) {
  return {name, colour, Style::kDashes, {from, to, NAN, from, to}, {limit, limit, NAN, -limit, -limit}};
}

// The limits of `name`: in the title, and drawn where they are near enough not to flatten the curves.
void add_limits(Chart& chart, const std::vector<Limit>& limits, const std::string& name, double end) {
  std::string said;
  for (int joint = 1; joint <= kJoints; ++joint) {
    const Limit* limit = limit_of(limits, name, joint);
    if (limit == nullptr) continue;
    said += fmt::format("{}±{:.4g}", said.empty() ? "" : " and ", limit->limit);
    if (limit->reached < kNear * limit->limit) continue;
    chart.series.push_back(
        both_sides(fmt::format("limit {}", joint), kColour[static_cast<std::size_t>(joint - 1)], limit->limit, 0, end));
  }
  if (!said.empty()) chart.title += fmt::format(" (limits {} {})", said, unit_of_limit(name));
}

Chart tip_speed_chart(const Parameters& robot, const Trajectory& trajectory, const std::vector<Limit>& limits) {
  Chart chart = time_chart("Tip speed", "m/s");
  Series series{"tip", "#3a7d44", Style::kLine, {}, {}};
  for (const Sample& s : trajectory.samples) {
    series.x.push_back(s.time);
    series.y.push_back(std::sqrt(std::max(0.0, tip_speed_squared(robot, s.state.q[1], s.state.dq))));
  }
  chart.series.push_back(std::move(series));
  if (const Limit* limit = limit_of(limits, "tip_speed", 0)) {
    chart.title += fmt::format(" (limit {:.4g} m/s)", limit->limit);
    chart.series.push_back(
        {"limit", "#3a7d44", Style::kDashes, {0, trajectory.end_time()}, {limit->limit, limit->limit}});
  }
  return chart;
}

std::vector<Chart> motion_charts(const PlanRecord& record, const std::vector<Limit>& limits) {
  const Trajectory& trajectory = *record.trajectory;
  const std::vector<Sample>& rows = trajectory.samples;
  const double end = trajectory.end_time();
  Chart positions = time_chart("Positions", "rad");
  add_joints(positions, rows, "link", link, kColour);
  add_joints(positions, rows, "motor", motor, kPale, Style::kThinLine);
  add_limits(positions, limits, "link_position", end);
  Chart springs = time_chart("Spring deflections", "rad");
  add_joints(springs, rows, "spring", deflection, kColour);
  add_limits(springs, limits, "spring_deflection", end);
  Chart torques = time_chart("Motor torques", "N m");
  add_joints(torques, rows, "motor", torque, kColour);
  add_limits(torques, limits, "torque", end);
  Chart motors = time_chart("Motor velocities", "rad/s");
  add_joints(motors, rows, "motor", motor_velocity, kColour);
  add_limits(motors, limits, "motor_velocity", end);
  Chart links = time_chart("Link velocities", "rad/s");
  add_joints(links, rows, "link", link_velocity, kColour);
  return {positions, springs, torques, motors, links, tip_speed_chart(record.robot, trajectory, limits)};
}

// ---- data of the animation ----

double short_number(double value) { return std::stod(fmt::format("{:.6g}", value)); }
Json pair_json(const Pair<double>& values) { return {values[0], values[1]}; }

// Columns over time, thinned out to what an animation can show.
Json motion_json(const std::string& name, const std::vector<Sample>& samples) {
  Json json{{"name", name}};
  for (const char* column : {"time", "q1", "q2", "theta1", "theta2", "dtheta1", "dtheta2", "tau1", "tau2"}) {
    json[column] = Json::array();
  }
  const std::size_t stride = (samples.size() + kMostSamples - 1) / kMostSamples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i % stride != 0 && i + 1 != samples.size()) continue;
    const Sample& s = samples[i];
    json["time"].push_back(std::stod(fmt::format("{:.9g}", s.time)));
    for (std::size_t j = 0; j < kJoints; ++j) {
      const std::string joint = std::to_string(j + 1);
      json["q" + joint].push_back(short_number(s.state.q[j]));
      json["theta" + joint].push_back(short_number(s.state.theta[j]));
      json["dtheta" + joint].push_back(short_number(s.state.dtheta[j]));
      json["tau" + joint].push_back(short_number(s.torque[j]));
    }
  }
  return json;
}

// What is drawn with the arm, in m. page.js knows
//   {kind: "disc", center, radius}   {kind: "box", corners: [[x, y], [x, y]]}   {kind: "line", from, to, tolerance}
//   {kind: "arc", center, radius, from, to, tolerance} (angles from the x axis)   {kind: "point", at},
// all of them with a `label` if they like. Whatever a request gains that has a place in the plane goes here.
void add_vias(Json& scene, const JsonField& request, const std::vector<double>& times, const Parameters& robot) {
  const std::vector<JsonField> vias = request.at("via").items();
  for (std::size_t i = 0; i < vias.size(); ++i) {
    const Point<double> tip = tip_position(robot, vias[i].at("q").pair());
    scene.push_back({{"kind", "point"}, {"at", {tip.x, tip.y}}});
    if (i < times.size()) scene.back()["label"] = fmt::format("via, {:.4g} s", times[i]);
  }
}

void add_obstacles(Json& scene, const JsonField& task) {
  const auto obstacles = task.find("obstacles");
  if (!obstacles) return;
  for (const JsonField& disc : obstacles->items()) {
    scene.push_back({{"kind", "disc"}, {"center", disc.at("center").pair()}, {"radius", disc.at("radius").number()}});
  }
}

void add_tip_region(Json& scene, const JsonField& task) {
  if (const auto box = task.find("box")) {
    const std::vector<JsonField> corners = box->items();
    if (corners.size() != 2) box->fail("must be two corners");
    scene.push_back({{"kind", "box"}, {"corners", {corners[0].pair(), corners[1].pair()}}});
  }
  if (const auto line = task.find("line")) {
    scene.push_back({{"kind", "line"},
                     {"from", line->at("from").pair()},
                     {"to", line->at("to").pair()},
                     {"tolerance", line->at("tolerance").number()}});
  }
  if (const auto arc = task.find("arc")) {
    const Pair<double> center = arc->at("center").pair(), from = arc->at("from").pair(), to = arc->at("to").pair();
    const auto angle = [&](const Pair<double>& p) { return std::atan2(p[1] - center[1], p[0] - center[0]); };
    const double turn = std::remainder(angle(to) - angle(from), 2 * std::numbers::pi);  // the short way
    scene.push_back({{"kind", "arc"},
                     {"center", center},
                     {"radius", std::hypot(from[0] - center[0], from[1] - center[1])},
                     {"from", angle(from)},
                     {"to", angle(from) + turn},
                     {"tolerance", arc->at("tolerance").number()}});
  }
}

Json scene_json(const JsonField& plan, const Parameters& robot) {
  const JsonField request = plan.at("resolved_request");
  Json scene = Json::array();
  add_vias(scene, request, plan.at("via_times").numbers(), robot);
  add_obstacles(scene, request.at("task"));
  add_tip_region(scene, request.at("task"));
  return scene;
}

// ---- without knowing the springs ----

struct ComparedMotion {
  std::string name;
  const char* colour;
  ElasticRun run;
};

// The plan first, and then the textbook's profiles of the same duration; all followed by the same controller on the
// same elastic arm. Empty where the plan does not lead from rest to rest.
std::vector<ComparedMotion> compared_motions(const Parameters& robot, const Trajectory& plan) {
  const Sample &first = plan.samples.front(), &last = plan.samples.back();
  if (!ends_at_rest(robot, first) || !ends_at_rest(robot, last)) return {};
  std::vector<ComparedMotion> motions{{"this plan", "#2a9d4a", run_on_elastic_arm(robot, plan)}};
  for (const auto& [profile, colour] :
       {std::pair{Profile::kMinimumJerk, "#8c56b5"}, {Profile::kTrapezoidal, "#c43c3c"}}) {
    const Trajectory reference =
        rigid_reference(robot, profile, first.state.q, last.state.q, plan.end_time() - plan.start_time());
    motions.push_back({name(profile), colour, run_on_elastic_arm(robot, reference)});
  }
  return motions;
}

Cell against_limit(double value, double limit) { return cell(number(value), value > limit * 1.005 ? "over" : ""); }

void add_peaks(Rows& rows, const std::vector<ComparedMotion>& motions, const std::vector<Limit>& limits,
               const std::string& name, const std::string& label, Pair<double> ElasticRun::*peak) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    const Limit* limit = limit_of(limits, name, static_cast<int>(j + 1));
    const double allowed = limit == nullptr ? INFINITY : limit->limit;
    rows.push_back({cell(fmt::format("{} {}, at most ({})", label, j + 1, unit_of_limit(name)))});
    for (const ComparedMotion& m : motions) rows.back().push_back(against_limit((m.run.*peak)[j], allowed));
    rows.back().push_back(cell(number(allowed)));
  }
}

Rows comparison_table(const std::vector<ComparedMotion>& motions, const std::vector<Limit>& limits) {
  Rows rows(1);
  rows[0].push_back(cell(""));
  for (const ComparedMotion& m : motions) rows[0].push_back(cell(m.name));
  rows[0].push_back(cell("limit"));
  for (std::size_t j = 0; j < kJoints; ++j) {
    rows.push_back({cell(fmt::format("link {}, furthest from the goal after the end (rad)", j + 1))});
    for (const ComparedMotion& m : motions) rows.back().push_back(cell(number(m.run.residual[j], 3)));
    rows.back().push_back(cell(""));
  }
  rows.push_back({cell(fmt::format("both links within {:g} rad of it after (s)", kSettled))});
  for (const ComparedMotion& m : motions) {
    rows.back().push_back(cell(std::isfinite(m.run.settling_time) ? fmt::format("{:.3f}", m.run.settling_time)
                                                                  : fmt::format("more than {:g}", kWatchedAfterEnd)));
  }
  rows.back().push_back(cell(""));
  add_peaks(rows, motions, limits, "torque", "torque", &ElasticRun::peak_torque);
  add_peaks(rows, motions, limits, "spring_deflection", "spring deflection", &ElasticRun::peak_spring_deflection);
  add_peaks(rows, motions, limits, "motor_velocity", "motor velocity", &ElasticRun::peak_motor_velocity);
  return rows;
}

std::vector<Chart> comparison_charts(const std::vector<ComparedMotion>& motions, const Trajectory& plan,
                                     const std::vector<Limit>& limits) {
  std::vector<Chart> charts;
  const Sample& goal = plan.samples.back();
  for (std::size_t j = 0; j < kJoints; ++j) {
    Chart after = time_chart(fmt::format("Link {} after the end, from the goal", j + 1), "rad");
    for (const ComparedMotion& m : motions) {
      Series series{m.name, m.colour, Style::kLine, {}, {}};
      for (const Sample& s : m.run.samples) {
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
      needed.series.push_back(series_of(m.name, m.colour, m.run.samples, torque, j));
    }
    if (const Limit* limit = limit_of(limits, "torque", static_cast<int>(j + 1))) {
      needed.series.push_back(both_sides("limit", "#555", limit->limit, 0, motions.front().run.samples.back().time));
    }
    charts.push_back(std::move(needed));
  }
  return charts;
}

void add_comparison(ChartPage& page, const std::vector<ComparedMotion>& motions, const Trajectory& plan,
                    const std::vector<Limit>& limits, bool with_scene) {
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
  page.add_html(html_table(comparison_table(motions, limits)));
  for (const ComparedMotion& m : motions) {
    if (!m.run.failure.empty()) page.add_paragraph(m.name + ": " + m.run.failure, "warning");
  }
  page.add_html("<div class='pairs'>");
  page.add_charts(comparison_charts(motions, plan, limits));
  page.add_html("</div>\n");
}

// ---- sections ----

void add_verdict(ChartPage& page, const JsonField& plan) {
  const std::string status = plan.at("status").text(), reason = plan.at("reason").text();
  page.add_html(fmt::format("<p><span class='badge {}'>{}</span>", status == "certified" ? "good" : "bad",
                            escaped_html(spaced(status))));
  const double duration = plan.at("duration").number();
  if (std::isfinite(duration)) {
    page.add_html(fmt::format(" <b>{:.6g} s</b>, objective <b>{}</b>", duration,
                              number(plan.at("objective").at("total").number(), 6)));
  }
  page.add_html("</p>\n");
  if (!reason.empty()) page.add_paragraph(reason, "warning");
}

void add_motion(ChartPage& page, const PlanRecord& record, const JsonField& plan, const std::vector<Limit>& limits,
                const std::vector<ComparedMotion>& motions) {
  page.add_heading("Motion");
  page.add_html(kStage);
  page.add_charts(motion_charts(record, limits));
  page.add_html("</div>\n");

  Json data{{"arm", {{"length", pair_json(record.robot.link.length)}, {"radius", pair_json(record.robot.link.radius)}}},
            {"limits", Json::object()},
            {"scene", scene_json(plan, record.robot)},
            {"motions", Json::array()}};
  for (const char* name : {"torque", "spring_deflection"}) {
    const Limit *first = limit_of(limits, name, 1), *second = limit_of(limits, name, 2);
    if (first != nullptr && second != nullptr) data["limits"][name] = {first->limit, second->limit};
  }
  data["motions"].push_back(motion_json("this plan", record.trajectory->samples));
  for (std::size_t i = 1; i < motions.size(); ++i) {
    data["motions"].push_back(motion_json(motions[i].name, motions[i].run.samples));
  }
  page.add_data("plan-data", data.dump());
  page.add_script(kPlanPageScript);
}

void add_margins(ChartPage& page, const std::vector<Limit>& limits) {
  page.add_heading("Margins");
  Rows rows{{cell("limit"), cell("allowed"), cell("reached"), cell("unit"), cell(""), cell("share"), cell("margin"),
             cell("at"), cell("closed-loop rollout")}};
  for (const Limit& l : limits) {
    const double share = l.limit > 0 && std::isfinite(l.limit) ? 100 * l.reached / l.limit : 0;
    const std::string css = l.passed ? "" : "over";
    rows.push_back({cell(with_joint(l.name, l.joint)), cell(number(l.limit)), cell(number(l.reached, 6), css),
                    cell(std::string(unit_of_limit(l.name))),
                    html_cell(fmt::format("<span class='bar {}'><i style='width:{:.1f}%'></i></span>", css,
                                          std::clamp(share, 0.0, 100.0))),
                    cell(fmt::format("{:.1f} %", share)), cell(number(l.limit - l.reached, 3)),
                    html_cell(fmt::format("<button class='at' data-time='{0:.6f}'>{0:.4f} s</button>", l.time)),
                    cell(number(l.rollout, 6))});
  }
  page.add_html(html_table(rows));
}

std::vector<Cell> rollout_row(const std::string& name, const JsonField& loop, double tolerance) {
  const double link = loop.at("max_link_error_rad").number(), at_end = loop.at("final_link_error_rad").number();
  const bool required = loop.at("required").flag();
  return {cell(name),
          cell(number(link, 3), required && !(link <= tolerance) ? "over" : ""),
          cell(number(link / tolerance, 3)),
          cell(number(loop.at("time_of_max_link_error").number())),
          cell(number(at_end, 3)),
          cell(number(loop.at("max_motor_error_rad").number(), 3)),
          cell(required ? "yes" : "no")};
}

void add_after_and_on_hardware(ChartPage& page, const JsonField& certificate) {
  const auto both = [](const JsonField& values) {
    const Pair<double> pair = values.pair();
    return fmt::format("{} and {}", number(pair[0], 3), number(pair[1], 3));
  };
  Rows rows{{cell("feedback torque in the closed loop (N m)"),
             cell(both(certificate.at("closed_loop").at("max_feedback_torque")))}};
  if (const JsonField residual = certificate.at("residual"); !residual.is_null()) {
    rows.push_back({cell(fmt::format("links from the goal within {} s after the end (rad)",
                                     number(residual.at("window").number()))),
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
      certificate.at("verdict").text() == "certified" ? "Certified" : "Failed", number(tolerance, 4)));
  for (const JsonField& failure : certificate.at("failures").items()) page.add_paragraph(failure.text(), "warning");
  const JsonField open = certificate.at("open_loop"), closed = certificate.at("closed_loop");
  page.add_html(html_table({{cell("rollout"), cell("link error (rad)"), cell("counts"), cell("at (s)"),
                             cell("link error at the end (rad)"), cell("motor error (rad)"), cell("required")},
                            rollout_row("open loop", open, tolerance),
                            rollout_row("closed loop", closed, tolerance)}));
  if (const std::string why_not = open.at("reason").text(); !why_not.empty()) {
    page.add_paragraph("Open loop is not required: " + why_not, "note");
  }
  add_after_and_on_hardware(page, certificate);
}

void add_mesh(ChartPage& page, const JsonField& mesh) {
  page.add_heading("Mesh and error");
  const std::vector<double> nodes = mesh.at("node_times").numbers();
  const std::vector<double> errors = mesh.at("errors").numbers();
  if (nodes.size() != errors.size() + 1) mesh.fail("must have one more of node_times than of errors");
  page.add_paragraph(fmt::format("{} intervals, {}; local error of an interval at most {} rad.", errors.size(),
                                 mesh.at("method").text(), number(mesh.at("error_estimate").number(), 3)));
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

void add_solver(ChartPage& page, const JsonField& solver) {
  page.add_heading("Solver");
  page.add_paragraph(fmt::format("Iterations: {}. Starts: {}. Distinct minima: {}.{}",
                                 number(solver.at("iterations").number(), 9), number(solver.at("starts").number(), 9),
                                 number(solver.at("distinct_minima").number(), 9),
                                 solver.at("warm").flag() ? " Begun with an earlier plan's solution." : ""));
  Rows rows{{cell("stage"), cell("intervals"), cell("iterations"), cell("objective"), cell("outcome")}};
  Series objectives{"stages", "#1f77b4", Style::kRings, {}, {}};
  double iterations = 0;
  for (const JsonField& stage : solver.at("stages").items()) {
    const double own = stage.at("iterations").number(), objective = stage.at("objective").number();
    iterations += own;
    rows.push_back({cell(stage.at("name").text()), cell(number(stage.at("intervals").number(), 9)),
                    cell(number(own, 9)), cell(number(objective, 7)), cell(stage.at("status").text())});
    objectives.x.push_back(iterations);
    objectives.y.push_back(objective);
  }
  page.add_html(html_table(rows));
  if (objectives.x.size() > 1) {
    page.add_html("<div class='pairs'>");
    page.add_charts({{"Objective at the end of each stage", "iterations", "objective", {objectives}}});
    page.add_html("</div>\n");
  }
}

void add_objective(ChartPage& page, const JsonField& plan) {
  page.add_heading("Objective");
  const JsonField terms = plan.at("objective").at("terms"), weights = plan.at("resolved_request").at("objective");
  Rows rows{{cell("term"), cell("value"), cell("weight"), cell("unit")}};
  for (const auto& term : terms.json().items()) {
    const auto weight = weights.find(term.key());
    rows.push_back({cell(spaced(term.key())), cell(number(terms.at(term.key()).number(), 6)),
                    cell(weight ? number(weight->number()) : ""), cell(std::string(unit_of_term(term.key())))});
  }
  page.add_html(html_table(rows));
}

void add_request(ChartPage& page, const JsonField& plan) {
  page.add_heading("Request");
  page.add_paragraph("As it was understood, with everything resolved; - is free.", "note");
  page.add_html(html_of_json(plan.at("resolved_request").json()));
  page.add_html("<details><summary>The robot it was planned for</summary>" + html_of_json(plan.at("robot").json()) +
                "</details>\n");
}

void add_what_else_there_is(ChartPage& page, const Json& plan) {
  static const std::set<std::string> shown{"version",  "request",    "status",       "reason",      "objective",
                                           "duration", "mesh",       "solver",       "certificate", "resolved_request",
                                           "robot",    "robot_hash", "request_hash", "back_off",    "timing"};
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
  const std::vector<Limit> limits = read_limits(plan);
  if (record.trajectory) {
    const std::vector<ComparedMotion> motions = compared_motions(record.robot, *record.trajectory);
    add_motion(page, record, plan, limits, motions);
    add_margins(page, limits);
    add_certificate(page, plan.at("certificate"));
    add_comparison(page, motions, *record.trajectory, limits, !scene_json(plan, record.robot).empty());
    add_mesh(page, plan.at("mesh"));
    add_objective(page, plan);
  }
  add_solver(page, plan.at("solver"));
  add_what_else_there_is(page, record.plan);
  add_request(page, plan);
  add_origin(page, plan);
  return page.html();
}

}  // namespace fjr
