// Rounding for people, and whole files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <random>
#include <set>
#include <string>

#include "common/atomic_file.h"
#include "common/read_file.h"
#include "common/rounded.h"
#include "tests/support/process.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

TEST(RoundedTo, IsTheNearestNumberOfSoManyDigits) {
  EXPECT_EQ(rounded_to(5.12345, 4), 5.123);
  EXPECT_EQ(rounded_to(-0.00099996, 4), -0.001);
  EXPECT_EQ(rounded_to(0, 4), 0);
  EXPECT_EQ(rounded_to(std::numeric_limits<double>::max(), 3), std::numeric_limits<double>::max());  // not infinite
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-300, 300);
  for (int i = 0; i < 1000; ++i) {
    const double value = std::pow(10, exponent(random)) * (i % 2 == 0 ? 1 : -1);
    EXPECT_EQ(rounded_to(value, 17), value);
    EXPECT_NEAR(rounded_to(value, 6) / value, 1, 0.5e-5);  // half of the last digit, of a first digit of 1
  }
}

// In a locale that writes a comma, which is made for this.
TEST(RoundedTo, KnowsNoLocale) {
  const fs::path folder = fs::temp_directory_path() / ("fjr_locale_" + std::to_string(::getpid()));
  fs::create_directory(folder);
  const std::string made = "localedef -i de_DE -f UTF-8 " + (folder / "de_DE.UTF-8").string();
  ASSERT_EQ(std::system(made.c_str()), 0) << made;
  ::setenv("LOCPATH", folder.c_str(), 1);
  ASSERT_NE(std::setlocale(LC_ALL, "de_DE.UTF-8"), nullptr);
  EXPECT_NE(std::strtod("5.123", nullptr), 5.123);  // what the numbers would be
  EXPECT_EQ(rounded_to(5.12345, 4), 5.123);
  std::setlocale(LC_ALL, "C");
  fs::remove_all(folder);
}

TEST(ReadFile, TellsNoFileFromOneThatCannotBeRead) {
  const fs::path folder = fs::temp_directory_path() / ("fjr_read_file_test_" + std::to_string(::getpid()));
  fs::create_directory(folder);
  const std::string bytes(200'000, '\0');
  write_file(folder / "file", bytes);
  EXPECT_EQ(read_file(folder / "file"), bytes);
  EXPECT_EQ(read_file(folder / "none"), std::nullopt);
  EXPECT_EQ(read_file(folder / "file" / "none"), std::nullopt);
  EXPECT_THROW((void)read_file(folder), std::runtime_error);
  fs::remove_all(folder);
}

// Two containers that share a folder have processes of the same number.
TEST(TemporaryBeside, IsAnotherNameEveryTime) {
  std::set<fs::path> names;
  for (int i = 0; i < 100; ++i) names.insert(temporary_beside("out/plan.json"));
  EXPECT_EQ(names.size(), 100u);
  EXPECT_EQ(names.begin()->parent_path(), "out");
}

}  // namespace
}  // namespace fjr
