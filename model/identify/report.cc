#include "model/identify/report.h"

#include <fmt/format.h>

#include <filesystem>

#include "common/chart_page.h"
#include "model/identify/charts.h"

namespace fjr {
namespace {

std::vector<std::vector<std::string>> table(const Estimate& e) {
  std::vector<std::vector<std::string>> rows = {{"parameter", "value", "standard error", "95 % interval", "unit"}};
  for (std::size_t i = 0; i < e.names.size(); ++i) {
    const double value = e.value[static_cast<Eigen::Index>(i)], error = e.standard_error(e.names[i]);
    const bool assumed = e.is_assumed(e.names[i]);
    rows.push_back({e.names[i], fmt::format("{:.6g}", value), assumed ? "assumed" : fmt::format("{:.2g}", error),
                    assumed ? "" : fmt::format("{:.6g} to {:.6g}", value - 1.96 * error, value + 1.96 * error),
                    e.units[i]});
  }
  return rows;
}

void add_section(const Estimate& e, ChartPage& page) {
  page.add_heading(fmt::format("{}, joint {}", e.procedure, e.joint + 1));
  page.add_table(table(e));
  for (const std::string& warning : e.warnings) page.add_paragraph(warning, "warning");
  page.add_charts(charts_of(e));
  page.add_paragraph(
      fmt::format("{} points, residual {:.3g} {} rms, R\u00b2 = {:.8f}. {}, SHA-256 {}", e.points, e.residual_rms,
                  e.residual_unit, e.r_squared, std::filesystem::path(e.log).filename().string(), e.hash),
      "note");
}

void add_agreement(const std::vector<Agreement>& agreements, ChartPage& page) {
  if (agreements.empty()) return;
  page.add_heading("What two logs say");
  std::vector<std::vector<std::string>> rows = {
      {"parameter", "by", "value", "by", "value", "unit", "standard errors apart"}};
  for (const Agreement& a : agreements) {
    rows.push_back({a.parameter, a.first, fmt::format("{:.6g} \u00b1 {:.2g}", a.first_value, a.first_error), a.second,
                    fmt::format("{:.6g} \u00b1 {:.2g}", a.second_value, a.second_error), a.unit,
                    fmt::format("{:.1f}", a.standard_errors_apart())});
  }
  page.add_table(rows);
  for (const Agreement& a : agreements) {
    if (a.standard_errors_apart() >= kDoubtfulApart) page.add_paragraph(a.sentence(), "warning");
  }
}

void add_changes(const std::vector<Change>& changes, ChartPage& page) {
  if (changes.empty()) return;
  page.add_heading("Against the robot known before");
  std::vector<std::vector<std::string>> rows = {{"parameter", "known", "identified", "standard error", "times"}};
  for (const Change& c : changes) {
    rows.push_back({c.name, fmt::format("{:.6g}", c.known), fmt::format("{:.6g}", c.found),
                    fmt::format("{:.2g}", c.error), c.known == 0 ? "" : fmt::format("{:.4g}", c.found / c.known)});
  }
  page.add_table(rows);
  for (const Change& c : changes) {
    if (c.is_large()) page.add_paragraph(c.sentence(), "warning");
  }
}

}  // namespace

std::string format_identification_report(const std::vector<Estimate>& estimates, const std::vector<Change>& changes) {
  ChartPage page("Identification");
  page.add_paragraph("The figures of section IV of the paper, redrawn from the logs, each with its fit and residuals.");
  add_agreement(agreements(estimates), page);
  add_changes(changes, page);
  for (const Estimate& e : estimates) add_section(e, page);
  return page.html();
}

}  // namespace fjr
