#include "planner/results/report/repetition_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "model/encoder.h"
#include "planner/results/report/html_table.h"
#include "planner/results/report/time_charts.h"

namespace fjr {
namespace {

double in_counts(double angle, std::size_t j, const Parameters& robot) {
  return angle / count_angle(robot.encoder.link_counts[j]);
}

// Describes the fraction of the correction that limits, task and executor have permitted.
std::string correction_taken(const JsonField& repetition) {
  const double fraction = repetition.at("fraction").number();
  std::string text = fraction == 1  ? "All of the correction was taken."
                     : fraction > 0 ? fmt::format("{} of the correction was taken.", number_text(fraction))
                                    : std::string("The rows are those of the last run.");
  for (const JsonField& reason : repetition.at("reasons").items()) text += fmt::format(" {}.", reason.text());
  return text;
}

// Adds the runs. A plan.json of an earlier version has none.
void add_runs(ChartPage& page, const JsonField& repetition, const Parameters& robot) {
  const auto runs = repetition.find("runs");
  if (!runs || runs->items().empty()) return;
  Rows rows{{cell("run"), cell("link 1 off the plan (counts rms)"), cell("link 2")}};
  Chart chart{"Links off the plan, by run", "run", "counts rms", {}};
  chart.logarithmic_y = true;
  for (std::size_t j = 0; j < kJoints; ++j) {
    chart.series.push_back({fmt::format("link {}", j + 1), kJointColour[j], Style::kLine, {}, {}});
  }
  for (const JsonField& run : runs->items()) {
    const double number = run.at("number").number();
    const Joints<double> rms = run.at("link_error_rms_rad").pair();
    rows.push_back({cell(number_text(number, 9))});
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double counts = in_counts(rms[j], j, robot);
      rows.back().push_back(cell(number_text(counts, 3)));
      chart.series[j].x.push_back(number);
      chart.series[j].y.push_back(counts);
    }
  }
  page.add_html(html_table(rows));
  if (rows.size() < 3) return;
  page.add_html("<div class='pairs'>");
  page.add_charts({chart});
  page.add_html("</div>\n");
}

// Describes the run that the motion was corrected by: a file, or the ids given by a service.
std::string corrected_by(const JsonField& repetition) {
  std::string text;
  for (const char* key : {"log", "log_sha256", "motion", "run"}) {
    if (const auto told = repetition.find(key)) {
      text += fmt::format("{}{} {}", text.empty() ? "Corrected by " : ", ", spaced(key), told->text());
    }
  }
  return text;
}

void add_expected(ChartPage& page, const JsonField& repetition, const Parameters& robot) {
  Rows rows{{cell("these rows on"), cell("link 1 off the plan (counts rms)"), cell("link 2"), cell("nearest limit"),
             cell("of it")}};
  for (const JsonField& rehearsal : repetition.at("rehearsals").items()) {
    std::string nearest;
    double used = 0;
    for (const JsonField& limit : rehearsal.at("limits").items()) {
      const double share =
          std::max(limit.at("reached").number(), limit.at("rollout").number()) / limit.at("limit").number();
      if (!(share > used)) continue;
      used = share;
      const double joint = limit.at("joint").is_null() ? 0 : limit.at("joint").number();
      const std::string name = spaced(limit.at("name").text());
      nearest = joint > 0 ? fmt::format("{} {:.0f}", name, joint) : name;
    }
    const Joints<double> rms = rehearsal.at("link_error_rms_rad").pair();
    rows.push_back({cell(rehearsal.at("arm").text()), cell(number_text(in_counts(rms[0], 0, robot), 3)),
                    cell(number_text(in_counts(rms[1], 1, robot), 3)), cell(nearest),
                    cell(fmt::format("{:.1f} %", 100 * used), used > 1 ? "over" : "")});
    for (const JsonField& check : rehearsal.at("task").items()) {
      page.add_paragraph(fmt::format("{}, {}: clearance {} {}", rehearsal.at("arm").text(),
                                     spaced(check.at("name").text()), number_text(check.at("room").number(), 3),
                                     check.at("unit").text()));
    }
    for (const JsonField& broken : rehearsal.at("broken").items()) page.add_paragraph(broken.text(), "warning");
  }
  page.add_html(html_table(rows));
}

}  // namespace

void add_repetition(ChartPage& page, const JsonField& plan, const Parameters& robot) {
  const auto repetition = plan.find("repetition");
  if (!repetition || repetition->is_null()) return;
  page.add_heading("Repetitions");
  page.add_paragraph(fmt::format("These rows are for run {}, where the plan as it was planned is run 1. {}",
                                 number_text(repetition->at("number").number(), 9), correction_taken(*repetition)));
  page.add_paragraph(corrected_by(*repetition), "note");
  add_runs(page, *repetition, robot);
  add_expected(page, *repetition, robot);
}

}  // namespace fjr
