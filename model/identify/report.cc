#include "model/identify/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "model/chart_page.h"

namespace fjr {
namespace {

std::vector<std::vector<std::string>> table(const Estimate& e) {
  std::vector<std::vector<std::string>> rows = {{"parameter", "value", "standard error", "95 % interval", "unit"}};
  for (std::size_t i = 0; i < e.names.size(); ++i) {
    const double value = e.value[static_cast<Eigen::Index>(i)], error = e.standard_error(e.names[i]);
    const bool assumed = std::find(e.assumed.begin(), e.assumed.end(), e.names[i]) != e.assumed.end();
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
  page.add_charts(e.charts);
  page.add_paragraph(
      fmt::format("{} points, residual {:.3g} {} rms, R\u00b2 = {:.8f}. {}, SHA-256 {}", e.points, e.residual_rms,
                  e.residual_unit, e.r_squared, std::filesystem::path(e.log).filename().string(), e.hash),
      "note");
}

}  // namespace

std::string format_identification_report(const std::vector<Estimate>& estimates) {
  ChartPage page("Identification");
  page.add_paragraph("The figures of section IV of the paper, redrawn from the logs, each with its fit and residuals.");
  for (const Estimate& e : estimates) add_section(e, page);
  return page.html();
}

}  // namespace fjr
