// trajectory.csv: what is written reads back to the same bits; what is broken is refused by line and column.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kHeader = "time,q1,q2,dq1,dq2,theta1,theta2,dtheta1,dtheta2,tau1,tau2\n";
const std::string kRow0 = "0,1,2,3,4,5,6,7,8,9,10\n";
const std::string kRow1 = "0.5,1,2,3,4,5,6,7,8,9,10\n";

Trajectory parse(const std::string& text) {
  std::istringstream in(text);
  return parse_csv(in, "t.csv");
}

std::string format(const Trajectory& trajectory) {
  std::ostringstream out;
  format_csv(trajectory, out);
  return out.str();
}

// The message, or "accepted".
std::string complaint(const std::string& text) {
  try {
    parse(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

// A folder of its own, removed at the end.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("fjr_csv_test_" + std::to_string(::getpid()))) {
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  fs::path operator/(const std::string& name) const { return path_ / name; }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(path_), fs::directory_iterator()));
  }

 private:
  fs::path path_;
};

double any_finite_double(std::mt19937_64& random) {
  for (;;) {
    const double value = std::bit_cast<double>(random());
    if (std::isfinite(value)) return value;
  }
}

Trajectory random_trajectory(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Trajectory trajectory;
  for (int row = 0; row < 50; ++row) {
    Sample sample;
    sample.time = 0.001 * row + 1e-4 * std::uniform_real_distribution<>(0, 1)(random);
    for (int i = 0; i < kStates; ++i) sample.state[i] = any_finite_double(random);
    sample.torque = {any_finite_double(random), -0.0};
    trajectory.samples.push_back(sample);
  }
  return trajectory;
}

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

bool same_bits(const Sample& a, const Sample& b) {
  bool same = same_bits(a.time, b.time) && same_bits(a.torque[0], b.torque[0]) && same_bits(a.torque[1], b.torque[1]);
  for (int i = 0; i < kStates; ++i) same = same && same_bits(a.state[i], b.state[i]);
  return same;
}

TEST(Csv, EveryColumnArrivesWhereItBelongs) {
  const Trajectory trajectory = parse(kHeader + kRow0 + kRow1);
  ASSERT_EQ(trajectory.samples.size(), 2u);
  const Sample& s = trajectory.samples[1];
  EXPECT_EQ(s.time, 0.5);
  EXPECT_EQ(s.state.q, (Joints<double>{1, 2}));
  EXPECT_EQ(s.state.dq, (Joints<double>{3, 4}));
  EXPECT_EQ(s.state.theta, (Joints<double>{5, 6}));
  EXPECT_EQ(s.state.dtheta, (Joints<double>{7, 8}));
  EXPECT_EQ(s.torque, (Joints<double>{9, 10}));
}

TEST(Csv, RoundTripKeepsEveryBit) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Trajectory written = random_trajectory(seed);
    const Trajectory read = parse(format(written));
    ASSERT_EQ(read.samples.size(), written.samples.size());
    for (std::size_t i = 0; i < read.samples.size(); ++i) {
      EXPECT_TRUE(same_bits(read.samples[i], written.samples[i])) << "seed " << seed << " row " << i;
    }
    EXPECT_EQ(format(read), format(written));
  }
}

TEST(Csv, TimesAtMultiplesOfThePeriodPrintNeatly) {
  Trajectory trajectory;
  for (int i = 0; i < 3; ++i) trajectory.samples.push_back({.time = i / 1000.0, .state = {}, .torque = {}});
  EXPECT_EQ(format(trajectory),
            kHeader + "0,0,0,0,0,0,0,0,0,0,0\n0.001,0,0,0,0,0,0,0,0,0,0\n0.002,0,0,0,0,0,0,0,0,0,0\n");
}

TEST(Csv, MetadataIsSortedAndSurvives) {
  Trajectory trajectory = parse(kHeader + kRow0 + kRow1);
  trajectory.metadata = {{"robot_hash", "ab12"}, {"note", "a: b, c"}, {"empty", ""}};
  EXPECT_THAT(format(trajectory), testing::StartsWith("# empty: \n# note: a: b, c\n# robot_hash: ab12\ntime,"));
  EXPECT_EQ(parse(format(trajectory)).metadata, trajectory.metadata);
}

TEST(Csv, MetadataCannotForgeARow) {
  Trajectory trajectory = parse(kHeader + kRow0 + kRow1);
  trajectory.metadata["note"] = "first\n9,9,9,9,9,9,9,9,9,9,9\r\nrobot_hash: no";
  EXPECT_EQ(parse(format(trajectory)).samples.size(), 2u);
  EXPECT_EQ(parse(format(trajectory)).metadata.size(), 1u);
}

TEST(Csv, ColumnsMayComeInAnyOrderAndMayBeMore) {
  const Trajectory trajectory = parse(
      "note,tau2,tau1,dtheta2,dtheta1,theta2,theta1,dq2,dq1,q2,q1,time,tau1_plan\n"
      "anything,10,9,8,7,6,5,4,3,2,1,0,nan\n"
      ",10,9,8,7,6,5,4,3,2,1,0.5,\n");
  EXPECT_TRUE(same_bits(trajectory.samples[1], parse(kHeader + kRow0 + kRow1).samples[1]));
}

TEST(Csv, TolerantOfWhatEditorsDo) {
  const std::string crlf =
      "\xEF\xBB\xBF# a : b \r\n\r\n# no colon here\r\ntime , "
      "q1,\tq2,dq1,dq2,theta1,theta2,dtheta1,dtheta2,tau1,tau2\r\n"
      "0, 1 ,2,3,4,5,6,7,8,9,10\r\n#late: comment\r\n0.5,1,2,3,4,5,6,7,8,9,10";  // no end of line at the end
  const Trajectory trajectory = parse(crlf);
  EXPECT_EQ(trajectory.samples.size(), 2u);
  EXPECT_EQ(trajectory.metadata, (std::map<std::string, std::string>{{"a", "b"}, {"late", "comment"}}));
}

struct Broken {
  std::string name, text, message;
};
void PrintTo(const Broken& broken, std::ostream* out) { *out << broken.name; }

// The header with one word replaced, or a good first row and a bad second one.
std::string header_with(const std::string& from, const std::string& to) {
  std::string header = kHeader;
  header.replace(header.find(from), from.size(), to);
  return header + kRow0 + kRow1;
}
std::string second_row(const std::string& row) { return kHeader + kRow0 + row + "\n"; }
std::string tau2(const std::string& value) { return second_row("0.5,1,2,3,4,5,6,7,8,9," + value); }

const Broken kBroken[] = {
    {"empty", "", "t.csv: no header: expected a line 'time,q1,q2,dq1,"},
    {"only_comments", "# a: b\n# c: d\n", "t.csv: no header"},
    {"only_header", kHeader, "t.csv: 0 rows; a trajectory has at least 2"},
    {"one_row", kHeader + kRow0, "t.csv: 1 rows; a trajectory has at least 2"},
    {"no_header", kRow0 + kRow1, "t.csv: line 1: column time is missing in '0,1,2,3,4,5,6,7,8,9,10'"},
    {"missing_column", header_with(",tau1", ""), "t.csv: line 1: column tau1 is missing"},
    {"misspelt_column", header_with("theta2", "theta_2"), "column theta2 is missing"},
    {"upper_case_column", header_with("q1", "Q1"), "column q1 is missing"},
    {"quoted_column", header_with("time", "\"time\""), "column time is missing"},
    {"repeated_column", header_with("tau2", "tau2,tau2"), "t.csv: line 1: column 'tau2' is given twice"},
    {"repeated_extra_column", header_with("tau2", "tau2,x,x"), "column 'x' is given twice"},
    {"nameless_column", header_with("tau2", "tau2,"), "t.csv: line 1: a column without a name"},
    {"semicolons", "time;q1;q2;dq1;dq2;theta1;theta2;dtheta1;dtheta2;tau1;tau2\n", "line 1: column time is missing"},
    {"repeated_metadata", "# a: 1\n# a: 2\n" + kHeader + kRow0 + kRow1, "t.csv: line 2: 'a' is given twice"},
    {"word", tau2("abc"), "t.csv: line 3, column tau2: 'abc' is not a number"},
    {"word_in_time", second_row("x,1,2,3,4,5,6,7,8,9,10"), "t.csv: line 3, column time: 'x' is not a number"},
    {"word_in_the_middle", second_row("1,1,2,3,4,5,?,7,8,9,10"), "t.csv: line 3, column theta2: '?' is not a number"},
    {"empty_field", tau2(""), "column tau2: '' is not a number"},
    {"blank_field", tau2("  "), "column tau2: '' is not a number"},
    {"trailing_text", tau2("1.0x"), "'1.0x' is not a number"},
    {"unit", tau2("1.0 Nm"), "'1.0 Nm' is not a number"},
    {"two_numbers", tau2("1 2"), "'1 2' is not a number"},
    {"plus_sign", tau2("+1"), "'+1' is not a number"},
    {"hexadecimal", tau2("0x10"), "'0x10' is not a number"},
    {"lonely_minus", tau2("-"), "'-' is not a number"},
    {"half_exponent", tau2("1e"), "'1e' is not a number"},
    {"nan", tau2("nan"), "t.csv: line 3, column tau2: 'nan' is not finite"},
    {"nan_with_text", tau2("nan(1)"), "is not finite"},
    {"infinity", tau2("-inf"), "'-inf' is not finite"},
    {"long_infinity", tau2("INFINITY"), "'INFINITY' is not finite"},
    {"overflow", tau2("1e999"), "'1e999' is beyond double precision"},
    {"underflow", tau2("1e-999"), "'1e-999' is beyond double precision"},
    {"decimal_comma", second_row("0,5,1,2,3,4,5,6,7,8,9,10"),
     "t.csv: line 3: 12 fields where the header has 11 columns"},
    {"too_few_fields", second_row("0.5,1,2"), "t.csv: line 3: 3 fields where the header has 11 columns"},
    {"trailing_comma", tau2("1,"), "12 fields where the header has 11 columns"},
    {"second_header", kHeader + kRow0 + kHeader, "line 3, column time: 'time' is not a number"},
    {"same_time", kHeader + kRow0 + kRow0, "t.csv: line 3, column time: 0 does not come after 0 of the row before"},
    {"time_goes_back", kHeader + kRow1 + kRow0, "line 3, column time: 0 does not come after 0.5 of the row before"},
    {"line_counts_comments", "# c\n\n" + kHeader + "# c\n\n" + kRow0 + "z\n", "t.csv: line 7: 1 fields"},
    {"long_value", tau2(std::string(200, 'y')), "'" + std::string(40, 'y') + "...' is not a number"},
    {"control_characters", tau2("\x1b[2J\t\x80"), "column tau2: '?[2J?"},
    {"zero_byte", tau2(std::string("1\0", 2)), "'1?' is not a number"},
    {"old_mac_line_ends", "time\r1\r2\r", "line 1: column time is missing in 'time?1?2'"},
    {"long_line", std::string(20000, '#') + "\n", "t.csv: line 1: longer than 16384 characters"},
    {"long_line_without_end", kHeader + std::string(20000, '1'), "t.csv: line 2: longer than 16384 characters"},
};

class CsvBroken : public testing::TestWithParam<Broken> {};
TEST_P(CsvBroken, IsRefusedWithItsPlace) { EXPECT_THAT(complaint(GetParam().text), HasSubstr(GetParam().message)); }
INSTANTIATE_TEST_SUITE_P(Files, CsvBroken, testing::ValuesIn(kBroken), [](const auto& p) { return p.param.name; });

std::string with_rows(std::size_t rows) {
  std::string text = kHeader;
  for (std::size_t i = 0; i < rows; ++i) text += std::to_string(i) + ",1,2,3,4,5,6,7,8,9,10\n";
  return text;
}

TEST(Csv, AsManyRowsAsAllowedButNotOneMore) {
  EXPECT_EQ(parse(with_rows(kMaxRows)).samples.size(), kMaxRows);
  EXPECT_EQ(complaint(with_rows(kMaxRows + 1)), "t.csv: line 32770: more than 32768 rows");
}

// Never ends; counts what was taken.
class EndlessComments : public std::streambuf {
 public:
  std::size_t taken = 0;

 protected:
  int underflow() override {
    setg(text_, text_, text_ + sizeof(text_) - 1);
    taken += sizeof(text_) - 1;
    return '#';
  }

 private:
  char text_[5] = "# x\n";
};

TEST(Csv, AnEndlessFileIsRefusedEarly) {
  EndlessComments endless;
  std::istream in(&endless);
  EXPECT_THROW(parse_csv(in, "endless"), InputError);
  EXPECT_LT(endless.taken, 100'000u);
}

// Good files with random bytes replaced, removed, inserted or repeated: accepted or refused, never anything else.
std::string damaged(std::string text, std::mt19937_64& random) {
  const std::string likely = "0123456789.,-+eE#:\n\r \tinfa\"\x00\xff";
  const int changes = 1 + static_cast<int>(random() % 6);
  for (int i = 0; i < changes && !text.empty(); ++i) {
    const std::size_t at = random() % text.size();
    const char byte = random() % 4 ? likely[random() % likely.size()] : static_cast<char>(random());
    switch (random() % 4) {
      case 0:
        text[at] = byte;
        break;
      case 1:
        text.erase(at, 1 + random() % 8);
        break;
      case 2:
        text.insert(at, 1, byte);
        break;
      default:
        text.insert(at, text.substr(random() % text.size(), random() % 40));
        break;
    }
  }
  return text;
}

TEST(Csv, DamagedBytesAreOnlyEverAnInputError) {
  std::mt19937_64 random(20240611);
  Trajectory few = random_trajectory(3);
  few.samples.resize(5);
  const std::string good = "# robot_hash: ab\n" + format(few);
  int accepted = 0, refused = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string text = damaged(i % 2 ? good : kHeader + kRow0 + kRow1, random);
    try {
      const Trajectory trajectory = parse(text);
      ++accepted;
      ASSERT_GE(trajectory.samples.size(), 2u);
      for (std::size_t k = 1; k < trajectory.samples.size(); ++k) {
        ASSERT_GT(trajectory.samples[k].time, trajectory.samples[k - 1].time);
      }
    } catch (const InputError& error) {
      ++refused;
      ASSERT_THAT(error.what(), testing::StartsWith("t.csv: "));
    }
  }
  EXPECT_GT(accepted, 1000);  // the damage reaches beyond the first check
  EXPECT_GT(refused, 1000);
}

TEST(Csv, FileRoundTripLeavesNothingElseBehind) {
  const Folder folder;
  const Trajectory trajectory = random_trajectory(7);
  write_csv(trajectory, folder / "t.csv");
  write_csv(trajectory, folder / "t.csv");  // over the old one
  EXPECT_EQ(format(read_csv(folder / "t.csv")), format(trajectory));
  EXPECT_EQ(folder.files(), 1u);
}

TEST(Csv, FilesThatCannotBeReadAreNamed) {
  const Folder folder;
  const auto message = [](const fs::path& file) -> std::string {
    try {
      read_csv(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message(folder / "none.csv"), (folder / "none.csv").string() + ": no such file");
  EXPECT_THAT(message(folder / ""), HasSubstr("is a folder"));
  EXPECT_THAT(message("/dev/zero"), HasSubstr("/dev/zero: line 1: longer than 16384 characters"));
}

TEST(Csv, FilesThatCannotBeWrittenAreNamedAndLeaveNothing) {
  const Folder folder;
  fs::create_directory(folder / "taken");
  std::ofstream(folder / "taken/inside") << "x";
  try {
    write_csv(random_trajectory(1), folder / "taken");
    FAIL() << "written over a folder";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("cannot write " + (folder / "taken").string() + ": "));
  }
  EXPECT_THROW(write_file(folder / "no/such/folder.csv", ""), std::runtime_error);
  EXPECT_EQ(folder.files(), 1u);
}

TEST(Csv, NeverWritesWhatItWouldNotRead) {
  const Folder folder;
  Trajectory trajectory = random_trajectory(1);
  trajectory.samples[3].torque[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(write_csv(trajectory, folder / "t.csv"), std::invalid_argument);
  EXPECT_EQ(folder.files(), 0u);
}

}  // namespace
}  // namespace fjr
