// What a terminal and a pipe are told: misspelt words, degrees, progress.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <string>

#include "common/degrees.h"
#include "common/spelling.h"
#include "planner/program/progress_line.h"

namespace fjr {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::EndsWith;
using testing::HasSubstr;

TEST(Spelling, CountsWhatHasToBeChanged) {
  EXPECT_EQ(edit_distance("goal", "goal"), 0U);
  EXPECT_EQ(edit_distance("gaol", "goal"), 1U);  // neighbours exchanged
  EXPECT_EQ(edit_distance("gol", "goal"), 1U);
  EXPECT_EQ(edit_distance("goall", "goal"), 1U);
  EXPECT_EQ(edit_distance("gosl", "goal"), 1U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);  // the textbooks' example
  EXPECT_EQ(edit_distance("", "goal"), 4U);
}

TEST(Spelling, SuggestsTheNearestWordThatMayHaveBeenMeant) {
  EXPECT_EQ(did_you_mean("gaol", {"start", "goal", "via"}), "; did you mean goal?");
  EXPECT_EQ(did_you_mean("objectve", {"obstacles", "objective"}), "; did you mean objective?");
  EXPECT_EQ(did_you_mean("link_velocity", {"motor_velocity", "link_position", "tip_speed"}), "");
  EXPECT_EQ(did_you_mean("qq", {"dq", "q", "theta"}), "; did you mean dq?");
  EXPECT_EQ(did_you_mean("x", {"q"}), "");  // every letter is another
  EXPECT_EQ(did_you_mean(std::string(1000, 'x'), {"q"}), "");
}

TEST(Degrees, AreSuspectedWhereTheyExplainTheAngle) {
  EXPECT_EQ(degrees_suspected(45, -3.2, 3.2), "; angles are in rad, and 45 degrees are 0.785398 rad");
  EXPECT_EQ(degrees_suspected(-90, -3.2, 3.2), "; angles are in rad, and -90 degrees are -1.5708 rad");
  EXPECT_EQ(degrees_suspected(3.3, -3.2, 3.2), "");  // not even a turn
  EXPECT_EQ(degrees_suspected(270, -3.2, 3.2), "");  // outside as degrees too
  EXPECT_EQ(degrees_suspected(-30, 0.0, 3.2), "");   // the same
}

// Lines that went to a file, by a clock that stands still until it is set.
class Lines {
 public:
  ProgressLine::Output output(bool terminal) {
    return {file_.get(), terminal, [this] { return now; }};
  }
  std::string text() {
    std::fflush(file_.get());
    std::rewind(file_.get());
    std::string all;
    for (int c = std::fgetc(file_.get()); c != EOF; c = std::fgetc(file_.get())) all += static_cast<char>(c);
    return all;
  }

  ProgressLine::Clock::time_point now{seconds(1000)};

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_{std::tmpfile()};
};

Progress at(const char* stage) {
  Progress progress;
  progress.stage = stage;
  progress.iteration = 7;
  progress.objective = 0.5;
  return progress;
}

TEST(ProgressLine, APipeIsToldEveryTenSeconds) {
  Lines lines;
  ProgressLine line("reach", Talk::kUsual, lines.output(false));
  const Progress progress = at("start 1 of 4");
  for (int i = 0; i < 250; ++i, lines.now += milliseconds(100)) line.show(progress);
  EXPECT_EQ(lines.text(),
            "fjr: reach: 10 s: start 1 of 4, iteration 7, objective 0.5, violation 0.0e+00\n"
            "fjr: reach: 20 s: start 1 of 4, iteration 7, objective 0.5, violation 0.0e+00\n");
}

TEST(ProgressLine, ATerminalIsToldAtOnceInOneLineThatIsWiped) {
  Lines lines;
  {
    ProgressLine line("reach", Talk::kUsual, lines.output(true));
    line.show(at("start 1 of 4"));
    line.show(at("start 2 of 4"));  // too soon
    lines.now += milliseconds(100);
    line.show(at("start 3 of 4"));
  }
  const std::string text = lines.text();
  EXPECT_THAT(text, HasSubstr("start 1"));
  EXPECT_THAT(text, testing::Not(HasSubstr("start 2")));
  EXPECT_THAT(text, HasSubstr("start 3"));
  EXPECT_THAT(text, testing::Not(HasSubstr("\n")));
  EXPECT_THAT(text, EndsWith("\r\033[K"));
}

TEST(ProgressLine, QuietSaysNothingAndVerboseWhateverBegins) {
  Lines quiet, more;
  ProgressLine nothing("reach", Talk::kNothing, quiet.output(false)), all("reach", Talk::kMore, more.output(false));
  for (const char* stage : {"start 1 of 2", "start 1 of 2", "start 2 of 2"}) {
    nothing.show(at(stage));
    all.show(at(stage));
    quiet.now += seconds(20);
    more.now += milliseconds(500);
  }
  EXPECT_EQ(quiet.text(), "");
  EXPECT_EQ(more.text(), "fjr: reach: 0.0 s: start 1 of 2\nfjr: reach: 1.0 s: start 2 of 2\n");
}

TEST(ProgressLine, EstimatesFromTheStartsAndBoundsByTheWork) {
  Lines lines;
  ProgressLine line("reach", Talk::kUsual, lines.output(false));
  Progress progress = at("start 4 of 12");
  progress.starts = 3;
  progress.starts_planned = 12;
  progress.work = 15;
  progress.most_work = 60;
  lines.now += seconds(10);
  line.show(progress);  // 3 starts in 10 s, and 45 s of work at 1.5 s each second
  EXPECT_THAT(lines.text(), HasSubstr("reach: 10 s, 9 more starts in about 30 s, at most about 30 s more: start 4"));
  progress.deadline = 25;
  lines.now += seconds(10);
  line.show(progress);
  EXPECT_THAT(lines.text(), HasSubstr("reach: 20 s, 9 more starts in about 60 s, at most about 5 s more: start 4"));
}

}  // namespace
}  // namespace fjr
