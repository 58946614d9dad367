// The tables that fjr writes, read by pandas and GNU Octave with the very lines that docs/files.md gives for them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/batch/table.h"
#include "planner/executor/execution_log.h"
#include "planner/trajectory/trajectory.h"
#include "tests/support/process.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using testing::StartsWith;

// What a shell command writes to stdout and stderr.
std::string output_of(const std::string& command) {
  FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
  std::string text;
  for (int c = fgetc(pipe); c != EOF; c = fgetc(pipe)) text += static_cast<char>(c);
  pclose(pipe);
  return text;
}

// The line behind `program` in the table of docs/files.md, about another file.
std::string documented_line(const std::string& program, const fs::path& file) {
  const std::string page = contents(FJR_SOURCE_DIR "/docs/files.md"), row = "| " + program + " | `";
  const std::size_t begin = page.find(row) + row.size();
  std::string line = page.substr(begin, page.find("` |", begin) - begin);
  const std::size_t quote = line.find("\"out/") + 1;
  return line.replace(quote, line.find('"', quote) - quote, file.string());
}

class Tables : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    Trajectory trajectory;
    for (int i = 0; i < 3; ++i) {
      trajectory.samples.push_back({0.001 * i, State<double>{{-0.1 * i, 0.2}, {}, {}, {}}, {1.5e-7 * i, -2.25}});
    }
    trajectory.metadata = {{"payload", "0.1 kg"}, {"request", "8 of them"}};
    write_csv(trajectory, trajectory_);

    CommandedMotion motion;
    motion.log = {{0, {-0.5, 0}, {0, 0}, {0, 0.125}, {}}, {0.001, {0.25, 0}, {0, 0}, {0, 3}, {}}};
    log_ = write_log(motion, {}, folder_, {{"payload", "0.1"}});

    const auto row = [](const std::string& name, double q, const char* reason) {
      const Json plan{{"status", "infeasible"}, {"reason", reason}, {"duration", q}};
      return make_row({name, "", std::nullopt, Json{{"goal.q[0]", q}}}, plan);
    };
    const std::vector<Row> rows = {row("a#1", 0.8, "limit #1, of \"two\""), row("b", 1.25, "two\nlines")};
    std::ofstream(batch_) << table_csv(rows);
    std::ofstream(batch_json_) << Json{{"rows", rows}};
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string with_program(const std::string& name, const std::string& text, const std::string& command) const {
    const fs::path script = folder_ / name;
    std::ofstream(script) << text;
    return output_of(command + " " + script.string());
  }

  const fs::path folder_ = fs::temp_directory_path() / ("fjr_tables_test_" + std::to_string(::getpid()));
  const fs::path trajectory_ = folder_ / "trajectory.csv", batch_ = folder_ / "summary.csv",
                 batch_json_ = folder_ / "summary.json";
  fs::path log_;
};

TEST_F(Tables, AreReadByPandas) {
  std::string python;
  for (const char* candidate : {"python3", "/usr/bin/python3"}) {
    if (output_of(std::string(candidate) + " -c 'import pandas'").empty()) python = candidate;
  }
  if (python.empty()) GTEST_SKIP() << "no pandas here (python3-pandas)";
  const auto read = [&](const fs::path& file, const std::string& print) {
    const std::string script = "import pandas\n" + documented_line("pandas", file) + "\nprint(" + print + ")\n";
    return with_program("script.py", script, python);
  };
  EXPECT_EQ(read(trajectory_, "list(t.columns), len(t), t.q1.iloc[2], t.tau1.iloc[1], t.tau2.iloc[0]"),
            "['time', 'q1', 'q2', 'dq1', 'dq2', 'theta1', 'theta2', 'dtheta1', 'dtheta2', 'tau1', 'tau2'] 3 -0.2 "
            "1.5e-07 -2.25\n");
  EXPECT_EQ(read(log_, "list(t.columns)[:7], t.q1.tolist(), t.tau2.tolist()"),
            "['time', 'q1', 'q2', 'theta1', 'theta2', 'tau1', 'tau2'] [-0.5, 0.25] [0.125, 3.0]\n");
  EXPECT_EQ(read(batch_, "t.name.tolist(), t['axes.goal.q[0]'].tolist(), t.reason.tolist()"),
            "['a#1', 'b'] [0.8, 1.25] ['limit #1, of \"two\"', 'two\\nlines']\n");
}

TEST_F(Tables, AreReadByOctave) {
  if (output_of("octave-cli --version").find("GNU Octave") == std::string::npos) GTEST_SKIP() << "no GNU Octave here";
  const std::string numbers = "GNU Octave, numbers";
  const std::string script = documented_line(numbers, trajectory_) +
                             "\nprintf('%d x %d: %g %g %g\\n', size(t), t(3, 2), " + "t(2, 10), t(1, 11));\n" +
                             documented_line(numbers, log_) +
                             "\nprintf('%d x %d: %g %g\\n', size(t), t(2, 2), t(1, 7));\n" +
                             documented_line("GNU Octave, batches", batch_json_) +
                             "\nprintf('%d: %s, %g\\n', numel(t), t(1).name, t(2).duration);\n";
  EXPECT_THAT(with_program("script.m", script, "octave-cli --quiet --no-gui --no-init-file"),
              StartsWith("3 x 11: -0.2 1.5e-07 -2.25\n2 x 13: 0.25 0.125\n2: a#1, 1.25\n"));
}

}  // namespace
}  // namespace fjr
