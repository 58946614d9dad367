#include "planner/results/report/motion_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/rounded.h"
#include "model/kinematics.h"
#include "planner/problem/quantities.h"
#include "planner/results/report/plan_page_text.h"
#include "planner/results/report/robust_section.h"
#include "planner/results/report/time_charts.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostSamples = 1500;  // of a motion in the animation
constexpr double kNear = 0.45;              // a limit is drawn when a curve comes this near to it

constexpr Joints<const char*> kSecondColour{"#8c56b5", "#d0509a"};

double link(const Sample& s, std::size_t j) { return s.state.q[j]; }
double motor(const Sample& s, std::size_t j) { return s.state.theta[j]; }
double link_velocity(const Sample& s, std::size_t j) { return s.state.dq[j]; }

// Adds the robustness tubes of the limit `name`, or of the links' positions, around the first lines of the chart.
void add_tubes(Chart& chart, const std::optional<Tubes>& tubes, const std::string& name, int first_joint = 1) {
  if (!tubes) return;
  const std::size_t lines = std::min<std::size_t>(chart.series.size(), first_joint == 0 ? 1 : kJoints);
  for (std::size_t j = 0; j < lines; ++j) {
    const int joint = first_joint == 0 ? 0 : static_cast<int>(j) + 1;
    const std::vector<double>* half = tubes->find(name, joint);
    if (half == nullptr) continue;
    const std::string whose = joint == 0 ? "tube" : fmt::format("tube {}", joint);
    chart.series.push_back(tube_about(chart.series[j], whose, tubes->times, *half));
  }
}

void add_joints(Chart& chart, const std::vector<Sample>& samples, const std::string& what, Quantity quantity,
                const Joints<const char*>& colours, Style style = Style::kLine) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    chart.series.push_back(series_of(fmt::format("{} {}", what, j + 1), colours[j], samples, quantity, j, style));
  }
}

// Returns "±1.3", or "-1.2 to 1.4" if the middle is not zero.
std::string range_text(double middle, double limit) {
  if (middle == 0) return fmt::format("±{:.4g}", limit);
  return fmt::format("{:.4g} to {:.4g}", middle - limit, middle + limit);
}

// Adds the limits of `name` on both sides of the middle: always to the title, and as lines if they are so close to the
// curves that these are not flattened.
void add_limits(Chart& chart, const std::vector<ReachedLimit>& limits, const std::string& name, double end,
                const Joints<double>& middle = {}) {
  std::string said;
  for (int joint = 1; joint <= kJoints; ++joint) {
    const ReachedLimit* limit = find_limit(limits, name, joint);
    if (limit == nullptr) continue;
    const auto j = static_cast<std::size_t>(joint - 1);
    said += (said.empty() ? "" : " and ") + range_text(middle[j], limit->limit);
    if (limit->reached < kNear * limit->limit) continue;
    chart.series.push_back(both_sides(fmt::format("limit {}", joint), kJointColour[j], limit->limit, 0, end));
    for (double& y : chart.series.back().y) y += middle[j];
  }
  if (!said.empty()) chart.title += fmt::format(" (limits {} {})", said, unit_of_limit(name));
}

Chart tip_speed_chart(const Parameters& robot, const Trajectory& trajectory, const std::vector<ReachedLimit>& limits,
                      const std::optional<Tubes>& tubes) {
  Chart chart = time_chart("Tip speed", "m/s");
  Series series{"tip", "#3a7d44", Style::kLine, {}, {}};
  for (const Sample& s : trajectory.samples) {
    series.x.push_back(s.time);
    series.y.push_back(std::sqrt(std::max(0.0, tip_speed_squared(robot, s.state.q[1], s.state.dq))));
  }
  chart.series.push_back(std::move(series));
  add_tubes(chart, tubes, "tip_speed", 0);
  if (const ReachedLimit* limit = find_limit(limits, "tip_speed", 0)) {
    chart.title += fmt::format(" (limit {:.4g} m/s)", limit->limit);
    chart.series.push_back(
        {"limit", "#3a7d44", Style::kDashes, {0, trajectory.end_time()}, {limit->limit, limit->limit}});
  }
  return chart;
}

int first_joint_of(const QuantityInfo& info) { return info.of_tip ? 0 : 1; }

// Returns a chart of a limited quantity of the list. The lines of joints are called `line` and their number.
template <class Limited>
Chart limited_chart(const PlanRecord& record, const std::vector<ReachedLimit>& limits,
                    const std::optional<Tubes>& tubes, const std::string& title, const std::string& line) {
  const QuantityInfo& info = Limited::info;
  const int first = first_joint_of(info);
  constexpr Joints<double> kNoRate{};
  Chart chart = time_chart(title, info.unit);
  for (std::size_t j = 0; j < info.count(); ++j) {
    Series series{first == 0 ? "tip" : fmt::format("{} {}", line, j + 1), kJointColour[j], Style::kLine, {}, {}};
    for (const Sample& s : record.trajectory->samples) {
      series.x.push_back(s.time);
      series.y.push_back(Limited::value(Moment<double>{record.robot, s.state, s.torque, kNoRate})[j]);
    }
    chart.series.push_back(std::move(series));
  }
  add_tubes(chart, tubes, info.name, first);
  add_limits(chart, limits, info.name, record.trajectory->end_time());
  return chart;
}

// The quantities with charts that motion_charts() always draws.
using AlwaysDrawn = QuantityList<Torque, MotorVelocity, LinkPosition, SpringDeflection, LimitedTipSpeed>;

bool is_always_drawn(const QuantityInfo& info) {
  return std::any_of(AlwaysDrawn::infos.begin(), AlwaysDrawn::infos.end(),
                     [&](const QuantityInfo& drawn) { return same_quantity(drawn, info); });
}

// Returns charts of the other quantities that are limited; torque rates are not drawn.
std::vector<Chart> further_charts(const PlanRecord& record, const std::vector<ReachedLimit>& limits,
                                  const std::optional<Tubes>& tubes) {
  std::vector<Chart> charts;
  Quantities::visit([&](auto quantity) {
    const QuantityInfo& info = quantity.info;
    if (is_always_drawn(info) || info.bound == BoundOn::kControl) return;
    if (!find_limit(limits, info.name, first_joint_of(info))) return;
    charts.push_back(limited_chart<decltype(quantity)>(record, limits, tubes, info.name, "joint"));
  });
  return charts;
}

std::vector<Chart> motion_charts(const PlanRecord& record, const std::vector<ReachedLimit>& limits) {
  const Trajectory& trajectory = *record.trajectory;
  const std::vector<Sample>& rows = trajectory.samples;
  const double end = trajectory.end_time();
  const std::optional<Tubes> tubes = read_tubes(JsonField(record.plan, record.source));
  Chart positions = time_chart("Positions", "rad");
  add_joints(positions, rows, "link", link, kJointColour);
  add_joints(positions, rows, "motor", motor, kMotorColour, Style::kThinLine);
  add_tubes(positions, tubes, "link");
  add_limits(positions, limits, "link_position", end, record.robot.limits.link_middle);
  Chart links = time_chart("Link velocities", "rad/s");
  add_joints(links, rows, "link", link_velocity, kJointColour);
  std::vector<Chart> charts{positions,
                            limited_chart<SpringDeflection>(record, limits, tubes, "Spring deflections", "spring"),
                            limited_chart<Torque>(record, limits, tubes, "Motor torques", "motor"),
                            limited_chart<MotorVelocity>(record, limits, tubes, "Motor velocities", "motor"),
                            links,
                            tip_speed_chart(record.robot, trajectory, limits, tubes)};
  for (Chart& chart : further_charts(record, limits, tubes)) charts.push_back(std::move(chart));
  return charts;
}

double short_number(double value) { return rounded_to(value, 6); }
Json pair_json(const Joints<double>& values) { return {values[0], values[1]}; }

// Returns the columns over time, thinned out for the animation.
Json motion_json(const std::string& name, const std::vector<Sample>& samples) {
  Json json{{"name", name}};
  for (const char* column : {"time", "q1", "q2", "theta1", "theta2", "dtheta1", "dtheta2", "tau1", "tau2"}) {
    json[column] = Json::array();
  }
  const std::size_t stride = (samples.size() + kMostSamples - 1) / kMostSamples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i % stride != 0 && i + 1 != samples.size()) continue;
    const Sample& s = samples[i];
    json["time"].push_back(rounded_to(s.time, 9));
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

Json arm_json(const Parameters& robot) {
  return {{"length", pair_json(robot.link.length)}, {"radius", pair_json(robot.link.radius)}};
}

// Returns the data for plan_page.js, to which motions and poses are added later.
Json stage_json(const Parameters& robot, const Json& scene) {
  return {
      {"arm", arm_json(robot)},   {"gravity", {{"fraction", robot.mounting.gravity}, {"down", robot.mounting.down}}},
      {"limits", Json::object()}, {"scene", scene},
      {"motions", Json::array()}, {"poses", Json::array()}};
}

// Adds the limits that the picture shows values relative to.
void add_ring_limits(Json& data, const std::vector<ReachedLimit>& limits) {
  for (const char* name : {"torque", "spring_deflection"}) {
    const ReachedLimit *first = find_limit(limits, name, 1), *second = find_limit(limits, name, 2);
    if (first != nullptr && second != nullptr) data["limits"][name] = {first->limit, second->limit};
  }
}

// Adds the curves of a second plan to the charts of the first, in other colours. Those of the motor angles are left
// out, because they are close to those of the links.
void add_second(std::vector<Chart>& charts, const NamedPlan& second) {
  const std::vector<Chart> others = motion_charts(second.record, {});
  for (std::size_t i = 0; i < std::min(charts.size(), others.size()); ++i) {
    for (std::size_t k = 0; k < std::min<std::size_t>(others[i].series.size(), kJoints); ++k) {
      Series series = others[i].series[k];
      series.name += ", " + second.name;
      series.colour = kSecondColour[k];
      charts[i].series.push_back(std::move(series));
    }
  }
}

}  // namespace

void add_poses(ChartPage& page, const Parameters& robot, const JsonField& plan, const Json& scene) {
  page.add_heading("What was asked for");
  Json data = stage_json(robot, scene);
  const JsonField request = plan.at("resolved_request");
  bool all_known = true;
  const auto add = [&](const char* label, const JsonField& state) {
    const Joints<double> q = state.at("q").pair();
    const bool known = std::isfinite(q[0]) && std::isfinite(q[1]);
    if (known) data["poses"].push_back({{"label", label}, {"q", pair_json(q)}});
    all_known = all_known && known;
  };
  add("start", request.at("start"));
  add("goal", request.at("goal"));
  for (const JsonField& other : request.at("other_goals").items()) add("or this goal", other);
  page.add_html(kStage);
  page.add_html("</div>\n");
  page.add_paragraph("There is no motion. Coloured: the arm at the start; green: at the goal." +
                         std::string(all_known ? "" : " A goal with a free joint is not drawn."),
                     "note");
  page.add_data("plan-data", data.dump());
  page.add_script(kPlanPageScript);
}

void add_both_motions(ChartPage& page, const NamedPlan& first, const NamedPlan& second, const Json& scene,
                      const std::vector<ReachedLimit>& limits) {
  page.add_heading("Motion");
  page.add_html(kStage);
  std::vector<Chart> charts = motion_charts(first.record, limits);
  add_second(charts, second);
  page.add_charts(charts);
  page.add_html("</div>\n");
  Json data = stage_json(first.record.robot, scene);
  add_ring_limits(data, limits);
  for (const NamedPlan* plan : {&first, &second}) {
    data["motions"].push_back(motion_json(plan->name, plan->record.trajectory->samples));
    data["motions"].back()["arm"] = arm_json(plan->record.robot);
  }
  data["beside"] = 1;
  page.add_data("plan-data", data.dump());
  page.add_script(kPlanPageScript);
}

void add_motion(ChartPage& page, const PlanRecord& record, const Json& scene, const std::vector<ReachedLimit>& limits,
                const std::vector<ComparedMotion>& motions) {
  page.add_heading("Motion");
  page.add_html(kStage);
  page.add_charts(motion_charts(record, limits));
  page.add_html("</div>\n");

  Json data = stage_json(record.robot, scene);
  add_ring_limits(data, limits);
  data["motions"].push_back(motion_json("this plan", record.trajectory->samples));
  for (std::size_t i = 1; i < motions.size(); ++i) {
    data["motions"].push_back(motion_json(motions[i].name, motions[i].run.simulation.samples));
  }
  page.add_data("plan-data", data.dump());
  page.add_script(kPlanPageScript);
}

}  // namespace fjr
