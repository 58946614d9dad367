// The report of an identification, and the page of charts that it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "common/chart_page.h"
#include "model/identify/arm.h"
#include "model/identify/report.h"
#include "tests/model/noisy_logs.h"

namespace fjr {
namespace {

using testing::HasSubstr;

std::size_t count_of(const std::string& part, const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++count;
  return count;
}

std::string full_report() {
  std::vector<Estimate> estimates;
  for (const std::string& name : experiment_names()) {
    for (int joint = 0; joint < kJoints; ++joint) {
      estimates.push_back(identify_quietly(name, noisy_log(name, joint), joint));
    }
  }
  const Parameters known = load_parameters(kRobot);
  return format_identification_report(estimates, changes(known, combine(known, estimates)));
}

TEST(Report, RedrawsThePapersFiguresWithResiduals) {
  const std::string html = full_report();
  for (int figure : {3, 4, 6, 7, 8, 9, 10, 11, 12, 13, 14}) {
    EXPECT_THAT(html, HasSubstr("<figcaption><span>Fig. " + std::to_string(figure) + ": "));
  }
  EXPECT_EQ(count_of("<figcaption><span>Residuals of Fig", html), 10U);
  EXPECT_EQ(count_of("<canvas id='chart", html), count_of("\"x_label\":", html));  // each has its data
  for (const char* part : {"#e377c2", "#2ca02c", "#d62728", "#111111",             // the paper's branches
                           "\"logarithmic_x\":true", "ln q peak", "envelope", "h is not determined", "h &lt; -",
                           "What two logs say", "viscous, joint 1", "Against the robot known before"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
}

TEST(Report, NeedsNothingButItself) {
  std::string html = full_report();
  const std::size_t library = html.find(kChartJs);
  ASSERT_NE(library, std::string::npos);
  EXPECT_THAT(kChartJs, HasSubstr("Chart.js v"));
  for (const char* part : {"import(", "fetch(", "XMLHttpRequest", "</script"}) {
    EXPECT_THAT(kChartJs, testing::Not(HasSubstr(part)));
  }
  html.erase(library, std::string(kChartJs).size());
  for (const char* part : {"http", "src=", "href=", "url(", "@import", "<link", "NaN", "Infinity"}) {
    EXPECT_THAT(html, testing::Not(HasSubstr(part)));
  }
}

TEST(ChartPage, TextsCannotBreakThePage) {
  ChartPage page("<b>");
  page.add_paragraph("</script><script>alert(1)</script>");
  page.add_charts({{"\"><img>", "</script>", "y", {{"\xff", "red", Style::kLine, {1, NAN}, {2, 3}}}}});
  page.add_data("texts", R"(["</script><img>"])");
  const std::string html = page.html();
  EXPECT_EQ(count_of("</script>", html), 3U);  // the library's, the page's own, and the data's
  EXPECT_EQ(count_of("<img", html) + count_of("<b>", html), 0U);
  EXPECT_THAT(html, HasSubstr(R"({"x":null,"y":null})"));
}

}  // namespace
}  // namespace fjr
