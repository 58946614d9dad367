// Starting from an earlier plan: what it saves, and that nothing but the same robot's own file is taken.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "common/input_error.h"
#include "planner/library/learnt_plans.h"
#include "planner/ocp/collocate.h"
#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/results/solution_file.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

Problem problem_of(const std::string& yaml) {
  return parse_request(yaml, "request.yaml", {}, FJR_SOURCE_DIR "/config/robot.yaml");
}
Problem to(double q1, double q2) {
  return problem_of("start: {q: [0.3, 0.2]}\ngoal: {q: [" + std::to_string(q1) + ", " + std::to_string(q2) + "]}\n");
}

class Warm : public testing::Test {
 protected:
  static const Plan& first() {
    static const Plan plan = fjr::plan(to(0.8, -0.3), {});
    return plan;
  }
  static Plan from_first(const Problem& problem) {
    PlanOptions options;
    options.warm = WarmStart{first().solution, "first"};
    return plan(problem, options);
  }
};

// Roundings decide which neighbours do not converge: of 84 fastest motions whose goals were moved by up to 0.02 rad
// three.
TEST_F(Warm, NeighbouringGoalsNeedFewerFactorisationsForTheSameMotion) {
  const std::vector<Joints<double>> goals{{0.81, -0.31}, {0.79, -0.28}, {0.82, -0.3}, {0.8, -0.32}};
  std::size_t warm_ones = 0;
  int warm_factorisations = 0, cold_factorisations = 0;
  for (const Joints<double>& goal : goals) {
    const Problem neighbour = to(goal[0], goal[1]);
    const Plan warm = from_first(neighbour), cold = plan(neighbour, {});
    ASSERT_EQ(warm.status, PlanStatus::kCertified) << warm.reason;
    EXPECT_EQ(warm.warm, !warm.warm_refusal) << warm.warm_refusal.value_or("");
    EXPECT_FALSE(cold.warm);
    EXPECT_EQ(cold.warm_refusal, std::nullopt);  // none was given
    // Two meshes, two sets of margins: measured 2e-4 and less.
    EXPECT_NEAR(warm.duration, cold.duration, 1e-3 * cold.duration);
    if (!warm.warm) continue;
    ++warm_ones;
    warm_factorisations += warm.cost.factorisations;
    cold_factorisations += cold.cost.factorisations;
  }
  EXPECT_GE(warm_ones, 3U);
  EXPECT_LT(warm_factorisations, cold_factorisations);  // measured: 0.44
}

// With such a goal other limits are active, and at other times. A Newton step from the solution there is blocked by one
// after the other: without the quadratic program 13 of these 24 converge, with it 21. Roundings decide about some.
TEST_F(Warm, MostGoalsAllAroundAreReachedFromThePlanThereIs) {
  constexpr int kGoals = 24;
  int warm_ones = 0;
  for (int k = 0; k < kGoals; ++k) {
    const double angle = 2 * std::numbers::pi * k / kGoals;
    const Plan plan = from_first(to(0.8 + 0.05 * std::cos(angle), -0.3 + 0.05 * std::sin(angle)));
    EXPECT_EQ(plan.status, PlanStatus::kCertified) << plan.reason;
    if (plan.warm) ++warm_ones;
  }
  EXPECT_GE(warm_ones, 18);
}

TEST_F(Warm, OtherConstraintsAreNoStartAndThePlanIsMadeFromScratch) {
  Problem slow = to(0.8, -0.3);
  slow.limits.tip_speed = 1.5;  // a row more than the earlier solution has
  const Plan plan = from_first(slow);
  EXPECT_EQ(plan.status, PlanStatus::kCertified) << plan.reason;
  EXPECT_FALSE(plan.warm);
  EXPECT_EQ(plan.warm_refusal, "it was planned with other constraints, or another number of them");
  const Plan other = from_first(problem_of("start: {q: [0.3, 0.2]}\ngoal: {q: [0.5, 0]}\nvia: [{q: [0.4, 0.1]}]\n"));
  EXPECT_EQ(other.status, PlanStatus::kCertified) << other.reason;
  EXPECT_EQ(other.warm_refusal, "it passes another number of via points");
}

TEST_F(Warm, APlanThatTakesTooLongIsNoAnswer) {
  Problem problem = to(0.8, -0.3);
  problem.duration.max = 0.97 * first().duration;
  const Plan plan = from_first(problem);
  EXPECT_EQ(plan.status, PlanStatus::kInfeasible) << plan.reason;
  ASSERT_TRUE(plan.warm_refusal);
  EXPECT_THAT(*plan.warm_refusal, HasSubstr("s, more than is allowed"));
}

TEST_F(Warm, AnotherMethodIsNoStart) {
  Problem problem = to(0.8, -0.3);
  problem.method = "lobatto4";
  const Plan plan = from_first(problem);
  EXPECT_EQ(plan.status, PlanStatus::kCertified) << plan.reason;
  EXPECT_EQ(plan.method, "lobatto4");
  EXPECT_EQ(plan.warm_refusal, "it was planned with method hermite-simpson, and lobatto4 is asked for");
}

// The last iteration of all is held up until the deadline has passed: what was certified before is the plan, and says
// so.
TEST(Deadline, ThatCutsTheSearchIsTold) {
  using Clock = std::chrono::steady_clock;
  const Problem problem =
      problem_of("start: {q: [0, 0]}\ngoal: {q: [0.5, -0.3]}\nduration: 0.6\nobjective: efficient\n");
  PlanOptions options;
  options.starts = 3;
  options.jobs = 1;
  int all_tells = 0;
  options.on_progress = [&](const Progress&) { ++all_tells; };
  const Plan whole = plan(problem, options);
  ASSERT_EQ(whole.status, PlanStatus::kCertified) << whole.reason;
  ASSERT_GE(whole.refined, 2);
  EXPECT_FALSE(whole.cut_by_deadline);

  options.deadline = 3 * whole.timing.at("total") + 1;
  const auto end = Clock::now() + std::chrono::duration<double>(options.deadline + 0.1);  // plan() begins later
  int tells = 0;
  options.on_progress = [&](const Progress&) {
    if (++tells == all_tells) std::this_thread::sleep_until(end);
  };
  const Plan cut = plan(problem, options);
  EXPECT_EQ(cut.status, PlanStatus::kCertified) << cut.reason;
  EXPECT_TRUE(cut.cut_by_deadline);
}

class SolutionFile : public Warm {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    write_solution(file_, *first().solution, "mine");
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void put(const std::string& bytes) const { std::ofstream(file_, std::ios::binary) << bytes; }
  std::string refusal(const std::string& robot = "mine") const {
    try {
      (void)read_solution(file_, robot);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const fs::path folder_ = fs::temp_directory_path() / ("fjr_warm_test_" + std::to_string(::getpid()));
  const fs::path file_ = folder_ / kSolutionFile;
};

TEST_F(SolutionFile, KeepsEveryBit) {
  const Collocated &before = *first().solution, after = read_solution(file_, "mine");
  EXPECT_TRUE(after.setup.mesh == before.setup.mesh);
  EXPECT_EQ(after.setup.scheme.name, before.setup.scheme.name);
  EXPECT_EQ(after.setup.creep, before.setup.creep);
  ASSERT_EQ(after.setup.margins.size(), before.setup.margins.size());
  for (std::size_t k = 0; k < after.setup.margins.size(); ++k) {
    EXPECT_EQ(after.setup.margins[k], before.setup.margins[k]);
  }
  EXPECT_EQ(after.report.iterate.x, before.report.iterate.x);
  EXPECT_EQ(after.report.iterate.lambda, before.report.iterate.lambda);
  EXPECT_EQ(after.report.iterate.z_lower, before.report.iterate.z_lower);
  EXPECT_EQ(after.report.iterate.z_upper, before.report.iterate.z_upper);
}

TEST_F(SolutionFile, IsRefusedWhenItIsNotThisRobotsOrNoSolution) {
  EXPECT_THAT(refusal("other"),
              HasSubstr("solution.cbor: was planned for another robot or with another payload: mine"));
  const std::string good = bytes();
  put("");
  EXPECT_THAT(refusal(), HasSubstr("is no solution written by fjr plan"));
  put("q,theta\n1,2\n");
  EXPECT_THAT(refusal(), HasSubstr("is no solution written by fjr plan"));
  for (std::size_t length = 1; length < good.size(); length += good.size() / 50) {
    put(good.substr(0, length));
    EXPECT_THAT(refusal(), HasSubstr("is no solution written by fjr plan")) << length;
  }
  fs::remove(file_);
  EXPECT_THAT(refusal(), HasSubstr("cannot be read"));
}

// Any damage is either refused or leaves numbers, which a plan then starts from or not: nothing else may happen.
TEST_F(SolutionFile, SurvivesDamage) {
  const std::string good = bytes();
  for (std::size_t at = 0; at < good.size(); at += 1 + good.size() / 2000) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x5a);
    put(bad);
    (void)refusal();
  }
}

// A plan is named by its goal's first angle.
Problem named(double q1, double q2) {
  Problem problem = to(q1, q2);
  problem.name = std::to_string(q1).substr(0, 4);
  return problem;
}

std::string name_of(const std::optional<WarmStart>& warm) { return warm ? warm->name : "none"; }

TEST(LearntPlans, OfferTheNearestComparableOne) {
  Plan plan;
  plan.solution = std::make_shared<const Collocated>();
  LearntPlans plans(2, {});
  plans.remember(named(0.80, -0.3), "", plan);
  plans.remember(named(0.82, -0.3), "", plan);
  EXPECT_EQ(name_of(plans.nearest(to(0.81, -0.28))), "0.82");  // 0.02 rad from both: the later
  EXPECT_EQ(name_of(plans.nearest(to(0.79, -0.3))), "0.80");
  EXPECT_NEAR(*plans.nearest(to(0.79, -0.3))->away, 0.01, 1e-12);
  EXPECT_EQ(name_of(plans.nearest(to(0.90, -0.3))), "none");  // 0.08 rad
  Problem tightened = to(0.80, -0.3);
  tightened.limits.torque[0] = 10;
  EXPECT_EQ(name_of(plans.nearest(tightened)), "none");
  const Problem timed = problem_of("start: {q: [0.3, 0.2]}\ngoal: {q: [0.8, -0.3]}\nduration: 1\n");
  EXPECT_EQ(name_of(plans.nearest(timed)), "none");
  for (int again = 0; again < 3; ++again) plans.remember(named(0.82, -0.3), "", plan);  // drives nothing out
  EXPECT_EQ(name_of(plans.nearest(to(0.79, -0.3))), "0.80");
  plans.remember(named(0.84, -0.3), "", plan);  // the oldest makes room
  EXPECT_EQ(name_of(plans.nearest(to(0.80, -0.3))), "0.82");
  EXPECT_EQ(name_of(LearntPlans(0, {}).nearest(to(0.8, -0.3))), "none");
}

class Library : public Warm {
 protected:
  fs::path folder_ = fs::temp_directory_path() / ("fjr_library_" + std::to_string(::getpid()));
  ~Library() override { fs::remove_all(folder_); }
};

TEST_F(Library, FindsTheNearestOfItsFamilyWhateverElseIsThere) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> angle(-0.05, 0.05);
  const auto anywhere = [&](std::size_t i) {
    Problem problem = to(0.5 + angle(random), angle(random));
    problem.start.q = {0.3 + angle(random), angle(random)};
    if (i % 3 == 0) problem.limits.torque[0] = 10;  // another family
    problem.name = std::to_string(i);
    return problem;
  };
  PlanLibrary library(folder_, PlanLibrary::Access::kWrite);
  std::vector<Problem> there;
  for (std::size_t i = 0; i < 60; ++i) {
    there.push_back(anywhere(i));
    ASSERT_TRUE(library.add(there.back(), "", 1, *first().solution));
    EXPECT_TRUE(library.has(there.back()));
  }
  std::size_t found = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    const Problem asked = anywhere(i);
    std::string nearest;
    double least = kNearby;
    for (std::size_t k = 0; k < there.size(); ++k) {
      const double away = distance(asked, there[k]);
      if ((k % 3 == 0) == (i % 3 == 0) && away <= least) nearest = there[k].name, least = away;
    }
    const auto neighbour = library.nearest(asked);
    EXPECT_EQ(neighbour ? neighbour->entry.name : "", nearest);
    found += neighbour ? 1 : 0;
    EXPECT_FALSE(library.has(asked));
  }
  EXPECT_GT(found, 5U);
  EXPECT_LT(found, 60U);
  const auto same = library.nearest(there[1]);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->solution->report.iterate.x, first().solution->report.iterate.x);  // to the bit
  ASSERT_EQ(library.families().size(), 2U);
  EXPECT_EQ(library.families()[0].plans, 40U);
}

TEST_F(Library, KeepsTheBetterOfTwoPlansOfOneProblem) {
  PlanLibrary library(folder_, PlanLibrary::Access::kWrite);
  const Problem problem = to(0.5, 0);
  for (const double objective : {2.0, 1.0, 3.0}) library.add(problem, "", objective, *first().solution);
  EXPECT_EQ(library.nearest(problem)->entry.objective, 1);
  EXPECT_EQ(library.families()[0].plans, 1U);
}

TEST_F(Library, IsLookedUpByTheJointAnglesOfStartAndGoalOnly) {
  const auto family = [](const std::string& yaml) { return family_of(problem_of(yaml)); };
  const auto plain = family("start: {q: [0, 0]}\ngoal: {q: [0.5, 0]}\n");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain, family("start: {q: [0.1, 0.3]}\ngoal: {q: [-0.5, 0.2]}\nseed: 7\nsearch: thorough\n"));
  for (const char* other : {"duration: 1", "limits: {torque: [11, 5]}", "payload: 0.1", "method: lobatto4",
                            "obstacles: [{center: [0.5, 0.5], radius: 0.02}]", "via: [{q: [0.2, 0.1]}]",
                            "objective: {time: 1, effort: 0.1}"}) {
    EXPECT_NE(plain, family(std::string("start: {q: [0, 0]}\ngoal: {q: [0.5, 0]}\n") + other + "\n")) << other;
  }
  EXPECT_EQ(family("start: {q: [0, 0]}\ngoal: {q: [0.5, free]}\n"), std::nullopt);
}

TEST_F(Library, KeepsWhatAServiceHasLearntOverItsEnd) {
  Plan plan;
  plan.solution = first().solution;
  {
    LearntPlans learnt(0, folder_);
    learnt.remember(named(0.80, -0.3), "", plan);
    learnt.remember(named(0.81, -0.3), "", plan);  // 0.01 rad: too near to be worth keeping
    learnt.remember(named(0.83, -0.3), "", plan);
  }
  LearntPlans next(0, folder_);
  EXPECT_EQ(name_of(next.nearest(to(0.81, -0.3))), "0.80");
  EXPECT_EQ(name_of(next.nearest(to(0.82, -0.3))), "0.83");
  EXPECT_EQ(name_of(next.nearest(to(0.86, -0.3))), "none");
}

TEST_F(Library, ThatCannotBeUsedKeepsNoPlanFromBeingMade) {
  std::ofstream(folder_) << "a file where the folder should be";
  Plan plan;
  plan.solution = first().solution;
  LearntPlans learnt(1, folder_);
  EXPECT_EQ(name_of(learnt.nearest(to(0.80, -0.3))), "none");
  learnt.remember(named(0.80, -0.3), "", plan);
  EXPECT_EQ(name_of(learnt.nearest(to(0.80, -0.3))), "0.80");  // from memory
}

}  // namespace
}  // namespace fjr
