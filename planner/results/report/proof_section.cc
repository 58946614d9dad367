#include "planner/results/report/proof_section.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "planner/results/report/html_table.h"

namespace fjr {
namespace {

// Appends the number of a joint or link to a name, unless the number is null.
std::string numbered(const std::string& name, const JsonField& number, const char* of = " ") {
  return spaced(name) + (number.is_null() ? "" : of + number_text(number.number()));
}

std::vector<Cell> loop_row(const std::string& name, const JsonField& loop, double tolerance) {
  const bool proven = loop.at("proven").flag();
  std::vector<Cell> row{cell(name)};
  for (const double error : loop.at("link_error_rad").numbers()) {
    row.push_back(cell(number_text(error / tolerance), proven ? "" : "over"));
  }
  row.insert(row.end(), {cell(number_text(loop.at("uncertainty_rad").number(), 2)),
                         cell(number_text(loop.at("until").number()), proven ? "" : "over"),
                         cell(number_text(loop.at("steps").number(), 9))});
  return row;
}

void add_loops(ChartPage& page, const JsonField& proof, double tolerance) {
  page.add_html(
      html_table({{cell("exact motion"), cell("link 1 off by at most (counts)"), cell("link 2 off by at most (counts)"),
                   cell("links known to (rad)"), cell("until (s)"), cell("steps")},
                  loop_row("open loop", proof.at("open_loop"), tolerance),
                  loop_row("closed loop", proof.at("closed_loop"), tolerance)}));
}

void add_limits(ChartPage& page, const JsonField& limits) {
  Rows rows{{cell("limit"), cell("allowed, with rounding"), cell("rows at most"), cell("exact motion at most")}};
  for (const JsonField& limit : limits.items()) {
    const double allowed = limit.at("allowed").number(), published = limit.at("published").number();
    rows.push_back({cell(numbered(limit.at("name").text(), limit.at("joint"))), cell(number_text(allowed, 9)),
                    cell(number_text(published, 9), published <= allowed ? "" : "over"),
                    cell(number_text(limit.at("rollout").number(), 9))});
  }
  page.add_html(html_table(rows));
}

void add_task(ChartPage& page, const JsonField& task) {
  Rows rows{{cell("on the way"), cell("clearance of the rows at least"), cell("of the exact motion"), cell("unit")}};
  for (const JsonField& row : task.items()) {
    rows.push_back({cell(numbered(row.at("name").text(), row.at("link"), ", link ")),
                    cell(number_text(row.at("room").number())), cell(number_text(row.at("rollout").number())),
                    cell(row.at("unit").text())});
  }
  if (rows.size() > 1) page.add_html(html_table(rows));
}

}  // namespace

void add_proof(ChartPage& page, const JsonField& certificate) {
  const auto proof = certificate.find("proof");
  if (!proof || proof->is_null()) return;
  page.add_heading("Proof");
  if (proof->at("verdict").text() == "proven") {
    page.add_paragraph(
        "Proven: enclosures of the exact motion hold these bounds with mathematical certainty, at all times and not "
        "only "
        "at the rows.");
  } else {
    page.add_paragraph(proof->at("reason").text(), "warning");
    page.add_paragraph("What is said of the exact motion below holds until the closed loop was followed to.");
  }
  add_loops(page, *proof, certificate.at("tolerance_rad").number());
  add_limits(page, proof->at("limits"));
  if (const auto task = proof->find("task")) add_task(page, *task);
}

}  // namespace fjr
