// service.yaml: whatever bytes it holds, a configuration or an InputError.
#include "planner/service/service_config.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <random>
#include <utility>

#include "common/input_error.h"
#include "tests/support/mutated_text.h"
#include "tests/support/process.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

TEST(ServiceConfig, MutatedFilesAreReadOrRefused) {
  const std::string shipped = contents(FJR_SOURCE_DIR "/config/service.yaml") + "security: keys\ninstance: cell-1\n";
  const fs::path file = fs::temp_directory_path() / ("fjr_service_config_test_" + std::to_string(::getpid()) + ".yaml");
  std::mt19937 random(3);
  int read = 0, refused = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::string text = mutated(shipped, random);
    std::ofstream(file, std::ios::binary) << text;
    try {
      const ServiceConfig config = load_service_config(file);
      EXPECT_LE(config.network.domain, 230u);
      EXPECT_LE(config.workers, 64u);
      EXPECT_GE(config.queue, 1u);
      EXPECT_GT(config.budget, 0);
      EXPECT_GE(config.longest_budget, config.budget);
      ++read;
    } catch (const InputError& error) {
      EXPECT_FALSE(error.problem().empty());
      ++refused;
    } catch (const std::exception& error) {
      FAIL() << "round " << i << ": " << error.what() << "\n" << text;
    }
    ASSERT_FALSE(HasFailure()) << text;
  }
  fs::remove(file);
  EXPECT_GT(read, 50);
  EXPECT_GT(refused, 100);
}

class RobotsTest : public testing::Test {
 protected:
  ~RobotsTest() override { fs::remove(file_); }
  ServiceConfig read(const std::string& text) const {
    std::ofstream(file_) << text;
    return load_service_config(file_);
  }
  std::string refusal_of(const std::string& text) const {
    try {
      (void)read(text);
    } catch (const InputError& error) {
      return error.field() + ": " + error.problem();
    }
    return "";
  }
  const fs::path file_ = fs::temp_directory_path() / ("fjr_robots_test_" + std::to_string(::getpid()) + ".yaml");
};

TEST_F(RobotsTest, EachIsServedByAnInstanceOfItsOwn) {
  const auto all = one_per_robot(read("{instance: cell, workers: 3, robots: [{id: a, robot: a.yaml}, {id: b}]}\n"));
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].robot_id, "a");
  EXPECT_EQ(all[0].robot, file_.parent_path() / "a.yaml");
  EXPECT_EQ(all[0].instance, "cell/a");
  EXPECT_EQ(all[1].robot_id, "b");
  EXPECT_EQ(all[1].robot, default_service_config().robot);
  EXPECT_EQ(all[1].instance, "cell/b");
  EXPECT_EQ(all[1].workers, 3u);
  EXPECT_EQ(one_per_robot(read("{instance: cell, robots: [{id: a}]}\n")).front().instance, "cell");
  EXPECT_EQ(one_per_robot(read("{instance: cell, robot_id: a}\n")).front().instance, "cell");
}

TEST_F(RobotsTest, WhatCannotBeMeantIsRefused) {
  EXPECT_EQ(refusal_of("{robot_id: a, robots: [{id: a}]}\n"),
            "robot_id: stands beside `robots`, which names id and file of each robot");
  EXPECT_EQ(refusal_of("robots: []\n"), "robots: an empty list: name at least one robot, or leave it out");
  EXPECT_EQ(refusal_of("robots: [{id: a}, {id: b}, {id: a}]\n"), "robots[2].id: the same as of a robot before it");
  EXPECT_EQ(refusal_of("robots: [{robot: a.yaml}]\n"), "robots[0].id: missing");
  EXPECT_EQ(refusal_of("{instance: " + std::string(60, 'i') + ", robots: [{id: left}]}\n"),
            "robots[0].id: with the instance's name 65 characters, above the 64 allowed");
  EXPECT_EQ(refusal_of("{ros2: {joint_trajectory: true}, robots: [{id: a}, {id: b}]}\n"),
            "ros2.joint_trajectory: true, but the topic is one robot's alone, and `robots` has several");
}

using BudgetsTest = RobotsTest;

TEST_F(BudgetsTest, TheDefaultIsNeverAboveTheLongest) {
  const auto budgets = [&](const std::string& text) {
    const ServiceConfig config = read(text);
    return std::pair(config.budget, config.longest_budget);
  };
  EXPECT_EQ(budgets("{}\n"), std::pair(60.0, 600.0));
  EXPECT_EQ(budgets("longest_budget: 10\n"), std::pair(10.0, 10.0));
  EXPECT_EQ(budgets("longest_budget: 90\n"), std::pair(60.0, 90.0));
  EXPECT_EQ(budgets("{budget: 10, longest_budget: 10}\n"), std::pair(10.0, 10.0));
  EXPECT_EQ(refusal_of("{budget: 60, longest_budget: 10}\n"),
            "budget: 60 s is outside (0, 10], as `longest_budget` is 10 s");
  EXPECT_EQ(refusal_of("budget: 601\n"), "budget: 601 s is outside (0, 600], as `longest_budget` is 600 s");
}

}  // namespace
}  // namespace fjr
