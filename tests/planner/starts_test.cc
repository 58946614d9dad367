// Starts that are tried at the same time: the plan is the same for any number of threads, work is bounded in the order
// in which it would be done one by one, and what a `search` is worth.
#include "planner/search/starts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/paired_thread.h"
#include "common/parallel.h"
#include "planner/conclusion.h"
#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/search/follow.h"
#include "planner/search/guesses.h"
#include "planner/search/race.h"

namespace fjr {
namespace {

using testing::ElementsAre;

Problem request(const std::string& yaml) {
  return parse_request(yaml, "request.yaml", FJR_SOURCE_DIR "/config", FJR_SOURCE_DIR "/config/robot.yaml");
}

const std::string kMove = "start: {q: [0, 0]}\ngoal: {q: [0.6, -0.4]}\n";

// ---- threads ----

TEST(ForEachIndex, DoesEachOnce) {
  for (const int threads : {1, 2, 5}) {
    std::vector<std::atomic<int>> done(37);
    for_each_index(done.size(), threads, [&](std::size_t i) { ++done[i]; });
    for (const auto& times : done) EXPECT_EQ(times, 1);
  }
}

TEST(ForEachIndex, DoesAllBeforeItThrowsTheFirst) {
  for (const int threads : {2, 5}) {
    std::atomic<int> done = 0;
    const auto task = [&](std::size_t i) {
      ++done;
      if (i % 2 == 1) throw std::runtime_error(std::to_string(i));
    };
    EXPECT_THAT([&] { for_each_index(8, threads, task); },
                testing::ThrowsMessage<std::runtime_error>(testing::Eq("1")));
    EXPECT_EQ(done, 8);
  }
}

// Pieces of pieces too: threads that have come to the end of theirs help with what begins later.
TEST(Threads, AreNeverMoreThanAllowedAndAllAreUsed) {
  for (const int most : {1, 2, 4}) {
    Threads threads(most);
    std::atomic<int> busy = 0, largest = 0, done = 0;
    const auto work = [&](std::size_t) {
      const int now = ++busy;
      for (int seen = largest; seen < now && !largest.compare_exchange_weak(seen, now);) continue;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      --busy;
      ++done;
    };
    threads.for_each(5, [&](std::size_t i) {
      if (i > 0) return work(i);
      for (int step = 0; step < 10; ++step) threads.for_each(6, work);
    });
    EXPECT_EQ(done, 64);
    EXPECT_EQ(largest, most);
  }
}

TEST(Threads, ServeAgainAfterOneHasThrown) {
  Threads threads(3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_THROW(threads.for_each(4, [](std::size_t) { throw std::runtime_error("no"); }), std::runtime_error);
  }
  std::atomic<bool> other = false;
  const auto caller = std::this_thread::get_id();
  threads.for_each(3, [&](std::size_t) {
    if (std::this_thread::get_id() != caller) other = true;
    for (int i = 0; i < 1000 && !other; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  EXPECT_TRUE(other);
}

// Two threads: while one does its task, the other begins many pieces alone; when the first is done, it helps.
TEST(Threads, HelpWithWhatWasBegunAlone) {
  Threads threads(2);
  const auto caller = std::this_thread::get_id();
  std::atomic<bool> begun = false, done = false, helped = false;
  const auto wait_for = [](const std::atomic<bool>& flag) {
    for (int ms = 0; ms < 1000 && !flag; ++ms) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  threads.for_each(2, [&](std::size_t i) {
    if (i == 1) {
      wait_for(begun);
      done = true;
      return;
    }
    threads.for_each(1000, [&](std::size_t) {
      if (std::this_thread::get_id() != caller) helped = true;
      begun = true;
      wait_for(done);
      if (!helped) std::this_thread::sleep_for(std::chrono::milliseconds(1));  // that thread is not idle yet
    });
  });
  EXPECT_TRUE(helped);
}

// A caller that only waits is not at work: two pieces of the other thread's task, of which each waits for the other to
// begin, are done at the same time. That takes a few attempts where the caller comes to its end late.
TEST(Threads, WorkInThePlaceOfACallerThatWaits) {
  Threads threads(2);
  const auto caller = std::this_thread::get_id();
  std::atomic<bool> begun = false;
  bool met = false;
  const auto wait_for = [](const auto& condition) {
    for (int ms = 0; ms < 100 && !condition(); ++ms) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  threads.for_each(2, [&](std::size_t) {
    if (std::this_thread::get_id() == caller) return wait_for([&] { return begun.load(); });
    begun = true;
    for (int attempt = 0; attempt < 20 && !met; ++attempt) {
      std::atomic<int> here = 0, seen = 0;
      threads.for_each(2, [&](std::size_t) {
        ++here;
        wait_for([&] { return here == 2 || seen > 0; });
        if (here == 2) ++seen;
      });
      met = seen == 2;
    }
  });
  EXPECT_TRUE(met);
}

// Whoever does the second piece, both are done when the pair is; also where the other thread has gone to sleep.
TEST(PairedThread, DoesItsPieceOfEveryPair) {
  constexpr std::size_t kPairs = 3000;
  std::vector<int> done(2 * kPairs, 0);
  PairedThread paired;
  bool helped = false;
  const auto caller = std::this_thread::get_id();
  for (std::size_t i = 0; i < kPairs; ++i) {
    bool elsewhere = false;
    const auto other = [&] {
      ++done[2 * i + 1];
      elsewhere = std::this_thread::get_id() != caller;
    };
    paired.both([&] { ++done[2 * i]; }, other);
    helped = helped || elsewhere;
    ASSERT_EQ(done[2 * i] + done[2 * i + 1], 2) << "pair " << i;
    if (i % 1000 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  // However busy the machine is: a caller that gives it time has its help.
  for (int ms = 0; ms < 2000 && !helped; ++ms) {
    paired.both([] { std::this_thread::sleep_for(std::chrono::milliseconds(1)); },
                [&] { helped = std::this_thread::get_id() != caller; });
  }
  EXPECT_TRUE(helped);
  EXPECT_GT(paired.end(), 0);
  EXPECT_THAT(done, testing::Each(1));
}

TEST(PairedThread, PassesOnWhatEitherPieceThrows) {
  std::atomic<int> done = 0;
  const auto fails = [] { throw std::runtime_error("no"); };
  const auto counts = [&] { ++done; };
  PairedThread paired;
  for (int i = 0; i < 100; ++i) {
    EXPECT_THROW(paired.both(fails, [] {}), std::runtime_error);
    EXPECT_THROW(paired.both(counts, fails), std::runtime_error);
  }
  paired.both(counts, counts);
  EXPECT_EQ(done, 102);
}

// Begun and ended as often as solves are: neither may wait for the other forever.
TEST(PairedThread, EndsWheneverItIsToldTo) {
  int done = 0;
  for (int i = 0; i < 300; ++i) {
    PairedThread paired;
    for (int k = 0; k < i % 3; ++k) paired.both([] {}, [&] { ++done; });
    if (i % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));  // it sleeps
  }
  EXPECT_EQ(done, 300);
}

TEST(Threads, DoPairsWithAndWithoutHelp) {
  for (const int most : {1, 2}) {
    Threads threads(most);
    int one = 0, other = 0;
    threads.in_pairs([&](const DoBoth& both) {
      for (int i = 0; i < 100; ++i) both([&] { ++one; }, [&] { ++other; });
    });
    EXPECT_EQ(one, 100);
    EXPECT_EQ(other, 100);
  }
}

TEST(Threads, AreIdleAgainAfterPairs) {
  Threads threads(2);
  EXPECT_THROW(threads.in_pairs([](const DoBoth&) { throw std::runtime_error("no"); }), std::runtime_error);
  threads.in_pairs([](const DoBoth& both) { both([] {}, [] {}); });
  std::atomic<bool> other = false;
  const auto caller = std::this_thread::get_id();
  threads.for_each(2, [&](std::size_t) {
    if (std::this_thread::get_id() != caller) other = true;
    for (int i = 0; i < 1000 && !other; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  EXPECT_TRUE(other);
}

// ---- sessions ----

using enum PieceOfWork;

// Of 30 that are allowed, each of four may take half; the third comes to more than all, so the fourth does not count.
TEST(Session, CountsPiecesInTheirOrderUntilAllIsTaken) {
  for (const int jobs : {1, 3}) {
    SessionOptions options;
    options.most_work = 60;  // of which finding motions may take half
    options.jobs = jobs;
    Session session(options);
    session.enter(Phase::kFinding);
    std::vector<int> taken(4);
    const std::vector<PieceOfWork> pieces = session.do_all(4, [&](std::size_t i, Session& own) {
      while (!own.interrupted(1)) ++taken[i];
    });
    EXPECT_THAT(taken, ElementsAre(14, 14, 14, 14)) << jobs;  // the step to 15 is told that it is the last
    EXPECT_THAT(pieces, ElementsAre(kCounts, kCounts, kIgnored, kIgnored)) << jobs;
    EXPECT_TRUE(session.interrupted());
    EXPECT_TRUE(session.account().cut_by_work);
  }
}

TEST(Session, AllowsMoreInThisPhaseAndInLaterOnes) {
  SessionOptions options;
  options.most_work = 60;
  Session session(options);
  session.enter(Phase::kFinding);
  EXPECT_TRUE(session.interrupted(30));
  session.allow_more(0.25);
  EXPECT_FALSE(session.interrupted(14));
  EXPECT_TRUE(session.interrupted(1));
  EXPECT_EQ(session.most_work(), 60);
  session.enter(Phase::kExplaining);
  EXPECT_FALSE(session.interrupted(29));
  EXPECT_TRUE(session.interrupted(1));
  EXPECT_EQ(session.most_work(), 75);
}

// Of 30, its own work takes 12 and may take all; each of those beside it may take half, and the third is too late.
TEST(Session, CountsItsOwnWorkBeforeWhatIsBesideIt) {
  for (const int jobs : {1, 3}) {
    SessionOptions options;
    options.most_work = 60;
    options.jobs = jobs;
    Session session(options);
    session.enter(Phase::kFinding);
    std::vector<int> taken(3);
    const std::vector<PieceOfWork> pieces = session.do_beside(
        [&] {
          for (int i = 0; i < 12; ++i) EXPECT_FALSE(session.interrupted(1));
        },
        3,
        [&](std::size_t i, Session& own) {
          while (!own.interrupted(1)) ++taken[i];
        });
    EXPECT_THAT(taken, ElementsAre(14, 14, 14)) << jobs;
    EXPECT_THAT(pieces, ElementsAre(kCounts, kCounts, kIgnored)) << jobs;
    EXPECT_TRUE(session.interrupted());
  }
}

TEST(Session, StopsAllPiecesAtOnce) {
  for (const int jobs : {1, 3}) {
    std::atomic<int> asked = 0;
    SessionOptions options;
    options.jobs = jobs;
    options.cancelled = [&] { return ++asked > 100; };
    Session session(options);
    session.enter(Phase::kFinding);
    session.do_all(4, [&](std::size_t, Session& own) {
      while (!own.interrupted(1e-3)) continue;
      EXPECT_TRUE(own.stopped());
    });
    EXPECT_TRUE(session.stopped());
    EXPECT_FALSE(session.deadline_passed());
    EXPECT_EQ(asked, 101);  // nobody asks again
  }
}

// ---- plans ----

bool same_bits(const Trajectory& a, const Trajectory& b) {
  return a.samples.size() == b.samples.size() &&
         std::memcmp(a.samples.data(), b.samples.data(), a.samples.size() * sizeof(Sample)) == 0;
}

TEST(Jobs, DoNotChangeThePlan) {
  const Problem problem = request(kMove + "duration: 0.8\nobjective: {effort: 1}\n");
  PlanOptions options;
  options.starts = 5;  // the first alone, then a wave of four
  const Plan alone = plan(problem, options);
  ASSERT_EQ(alone.status, PlanStatus::kCertified) << alone.reason;
  for (const int jobs : {2, 4}) {
    options.jobs = jobs;
    const Plan beside = plan(problem, options);
    ASSERT_TRUE(beside.trajectory);
    EXPECT_TRUE(same_bits(*alone.trajectory, *beside.trajectory)) << jobs;
    EXPECT_EQ(alone.iterations, beside.iterations);
    EXPECT_EQ(alone.minima, beside.minima);
    ASSERT_EQ(alone.stages.size(), beside.stages.size());
    for (std::size_t i = 0; i < alone.stages.size(); ++i) EXPECT_EQ(alone.stages[i].name, beside.stages[i].name);
  }
}

TEST(Thoroughness, IsANumberOfStarts) {
  const auto starts = [](const std::string& more) { return starts_to_try(request(kMove + more), 0, {}); };
  const int usual = starts("objective: {effort: 1}\nduration: 1\n");
  EXPECT_GT(usual, 1);
  EXPECT_EQ(starts("objective: {effort: 1}\nduration: 1\nsearch: default\n"), usual);
  EXPECT_EQ(starts("objective: {effort: 1}\nduration: 1\nsearch: quick\n"), 1);
  EXPECT_EQ(starts("objective: {effort: 1}\nduration: 1\nsearch: thorough\n"), 4 * usual);
  EXPECT_EQ(starts("search: quick\n"), 1);
  EXPECT_EQ(starts_to_try(request(kMove + "search: quick\n"), 7, {}), 7);  // --starts says more
}

// ---- races ----

TEST(WorthFollowing, IsWhatIsNeitherKnownNorTooFarBehind) {
  EXPECT_TRUE(worth_following(10.00, 0.01, {}, true, {}));
  EXPECT_TRUE(worth_following(10.00, 0.01, {10.03, 9.97}, true, {}));
  EXPECT_FALSE(worth_following(10.00, 0.01, {10.03, 10.0005}, true, {}));  // the same minimum
  EXPECT_FALSE(worth_following(10.00, 0.01, {9.95}, true, {}));
  EXPECT_TRUE(worth_following(10.00, 0.1, {9.00}, true, {}));  // the smoothest law tells little,
  EXPECT_TRUE(worth_following(10.00, 0.03, {9.85}, true, {}));
  EXPECT_FALSE(worth_following(10.00, 0.03, {9.75}, true, {}));
  EXPECT_FALSE(worth_following(-9.00, 0.01, {-10.00}, true, {}));  // rewards
}

// Of one motion that two starts came to, only the first goes all the way; what is alone does, whatever it comes to.
TEST(Race, FollowsEachMinimumOnce) {
  const Problem problem = request(kMove + "duration: 0.8\nobjective: {effort: 1}\n");
  Session session{SessionOptions{}};
  session.enter(Phase::kRefining);
  Findings found(problem);
  std::vector<Continuation> motions;
  for (const char* label : {"first", "second"}) {
    Continuation c(found.alternatives.front(), session, label);
    ASSERT_EQ(c.begin(first_guesses(problem, {}).front(), 400), StartOutcome::kNew);
    motions.push_back(std::move(c));
  }
  StepObjectives reached;
  const Raced raced = race(std::move(motions), reached, session);
  ASSERT_EQ(raced.arrived.size(), 1U);
  EXPECT_EQ(raced.arrived.front().label(), "first");
  EXPECT_EQ(raced.arrived.front().solution().setup.smoothing.friction_width, 0);
  ASSERT_EQ(raced.dropped.size(), 1U);
  EXPECT_EQ(raced.dropped.front().solution().setup.smoothing.friction_width, 0.1) << "before the first step";
}

// ---- starts that run out of iterations ----

TEST(Start, ThatRunsOutOfIterationsSaysSo) {
  const Problem problem = request(kMove);
  Session session{SessionOptions{}};
  session.enter(Phase::kFinding);
  Findings found(problem);
  const Start start{found.alternatives.front(), first_guesses(problem, {}).front(), "start"};
  found.start_iterations = 3;  // of 60 or more that it takes
  EXPECT_EQ(try_starts({start}, found, session).front(), TriedStart::kOutOfIterations);
  found.start_iterations = 400;
  EXPECT_EQ(try_starts({start}, found, session).front(), TriedStart::kSomewhere);
}

// A few iterations before its end its objective is nearly what it comes to, and its constraints nearly hold.
TEST(Start, AtItsIterationLimitGoesOnIfItsObjectiveIsTheLowest) {
  const Problem problem = request(kMove + "duration: 0.8\nobjective: {effort: 1}\n");
  Session session{SessionOptions{}};
  session.enter(Phase::kFinding);
  const auto shared = std::make_shared<const Problem>(problem);
  const Guess guess = first_guesses(problem, {}).front();
  const auto begun = [&](int most_iterations, const std::vector<double>& known) {
    Continuation c(shared, session, "start");
    const StartOutcome outcome = c.begin(guess, most_iterations, known);
    return std::pair{outcome, c.stages()};
  };
  const auto [outcome, stages] = begun(400, {});
  ASSERT_EQ(outcome, StartOutcome::kNew);
  const int too_few = stages.front().iterations - 4;
  const double objective = stages.front().objective;
  EXPECT_EQ(begun(too_few, {}).first, StartOutcome::kNoSolution);
  const auto [ahead, stages_of_ahead] = begun(too_few, {1.5 * objective});
  EXPECT_EQ(ahead, StartOutcome::kNew);
  EXPECT_EQ(stages_of_ahead.front().objective, objective);  // what the start is known by
  EXPECT_EQ(begun(too_few, {1.5 * objective, 0.9 * objective}).first, StartOutcome::kNoSolution);
}

// ---- arms that move already ----

// A motion of 0.2889 s passes both points. Guesses that stop at them come to 0.4202 s, turning back, and to
// "infeasible".
TEST(Starts, OfAMovingArmPassViaPoints) {
  const Plan plan = fjr::plan(request("start: {q: [0.536, -0.694], dq: [1.09, 2.33]}\ngoal: {q: [0.791, 0.939]}\n"
                                      "via: [{q: [0.5935, -0.4495]}, {q: [0.7326, 0.1236]}]\nduration: {max: 0.4}\n"),
                              {});
  ASSERT_EQ(plan.status, PlanStatus::kCertified) << plan.reason;
  EXPECT_LE(plan.duration, 0.2889 * (1 + 1e-3));  // what meshes and margins may cost
}

// A usual duration is one between rests. Judged by it this request was out of reach before anything was tried in the
// time that it gives, for the fastest motion that was found turns back and takes 0.18 s.
TEST(Starts, AnArmThatMovesAlreadyIsTriedInTheTimeThereIs) {
  const Plan plan =
      fjr::plan(request("start: {q: [0.40954, -0.37379], dq: [-1.4232, 4.1288], theta: [0.5322, -0.3735], "
                        "dtheta: [-1.765, 4.2178]}\n"
                        "goal: {q: [0.33831, -0.16713], dq: [-1.4232, 4.1288]}\nduration: 0.05005\n"
                        "objective: {copper: 1}\npath: {tolerance: 0.0314}\n"),
                {});
  EXPECT_EQ(plan.status, PlanStatus::kCertified) << plan.reason;
}

// ---- throws ----

// Random displacements of the straight motion seldom lead to throws in all directions.
TEST(Starts, OfAThrowMoveTheJointsInEveryPairOfDirectionsAtTheRelease) {
  const std::string reward = "start: {q: [0.3, -0.2]}\nobjective: {time: 1, tip_speed: 1}\n";
  for (const char* throwing :
       {"goal: {q: [0.1, 0.2]}\nvia: [{q: [0.9, -0.4]}]\n", "goal: {q: [0.9, -0.4], dq: free}\n"}) {
    const Problem problem = request(reward + throwing);
    const Joints<double> released{0.9, -0.4};
    std::set<std::pair<bool, bool>> directions;
    for (const Guess& guess : guesses_of(starts_of(problem, 8, {}))) {
      if (guess.name != "throwing") continue;
      const State<double> x = guess.state(guess.durations.front() / guess.duration());
      directions.emplace(x.dq[0] > 0, x.dq[1] > 0);
      for (std::size_t j = 0; j < kJoints; ++j) {
        EXPECT_NEAR(x.q[j], released[j], 1e-9);
        EXPECT_NEAR(std::abs(x.dq[j]), StartSettings{}.throwing_speed * problem.limits.motor_velocity[j], 1e-6);
      }
    }
    EXPECT_EQ(directions.size(), 4U) << throwing;
  }
}

TEST(Starts, OfAThrowWithAGivenVelocityLeaveTheDirectionAsItIs) {
  const Problem problem = request(
      "start: {q: [0.3, -0.2]}\ngoal: {q: [0.1, 0.2]}\nvia: [{q: [0.9, -0.4], dq: [2, 1]}]\n"
      "objective: {time: 1, tip_speed: 1}\n");
  for (const Guess& guess : guesses_of(starts_of(problem, 8, {}))) EXPECT_NE(guess.name, "throwing");
}

// From a guess that stops at the via points the fastest motion turns back between them, and takes 0.602 s.
TEST(Starts, AnArmThatIsToPassAPointWithAVelocityDoesNotTurnBackBefore) {
  const Plan result = plan(request("start: {q: [-0.762, -0.67]}\ngoal: {q: [-0.49, 1.294]}\n"
                                   "via: [{q: [-0.501, 0.763]}, {q: [-0.482, 1.063], dq: [-0.113, 7.019]}]\n"
                                   "limits: {torque_rate: [174, 114]}\n"),
                           {});
  ASSERT_EQ(result.status, PlanStatus::kCertified) << result.reason;
  EXPECT_LT(result.trajectory->end_time(), 0.39);  // measured 0.3805
}

// Likewise where it begins and ends moving. It took 0.988 s from a guess whose velocities did not fit each other.
TEST(Starts, AnArmThatBeginsAndEndsMovingDoesNotTurnBack) {
  const Plan result =
      plan(request("start: {q: [0.813, -1.486], dq: [-0.47, -4.801], theta: [0.747, -1.558], dtheta: [-5.399, 0.02]}\n"
                   "via: [{q: [0.775, -1.604]}, {q: [0.337, -0.993], dq: [-6.367, 4.505]}, {q: [0.197, -0.904]}]\n"
                   "goal: {q: [-0.252, -0.509], dq: [-6.769, 7.24]}\n"),
           {});
  ASSERT_EQ(result.status, PlanStatus::kCertified) << result.reason;
  EXPECT_LT(result.trajectory->end_time(), 0.215);  // measured 0.2078
}

// ---- ends that are free ----

// Link 1 may end anywhere. From a guess that ends beside its start, 0.58 rad, least effort holds it there; it is less
// than half where link 1 ends at 0.02 rad, whatever happens on the way there.
TEST(Starts, FreeJointsEndWhereTheyAreEasilyHeld) {
  const std::string move = "start: {q: [0.58, 1.04]}\nobjective: {time: 0.2, effort: 1}\n";
  const Plan given = plan(request(move + "goal: {q: [0.02, 1.14]}\nsearch: quick\n"), {});
  const Plan free = plan(request(move + "goal: {q: [free, 1.14]}\n"), {});
  ASSERT_EQ(given.status, PlanStatus::kCertified);
  ASSERT_EQ(free.status, PlanStatus::kCertified);
  EXPECT_LE(free.objective, given.objective * (1 + 1e-3));  // what meshes and margins may cost
}

TEST(Starts, OtherEndsComeInAdditionWhereMoreThanOneStartIsAskedFor) {
  const Problem free =
      request("start: {q: [0.58, 1.04]}\ngoal: {q: [free, 1.14]}\nduration: 1\nobjective: {effort: 1}\n");
  EXPECT_EQ(starts_of(free, 1, {}).always, 1U);
  EXPECT_EQ(starts_of(free, 12, {}).always, 14U);
}

// Where the arm starts hanging, the end that is easily held is the one that is expected anyway.
TEST(Starts, EndsThatAreTheSameAreTriedOnce) {
  const Problem free = request("start: {q: [0, 0]}\ngoal: {q: [free, 0.05]}\nduration: 1\nobjective: {effort: 1}\n");
  EXPECT_EQ(starts_of(free, 12, {}).always, 12U);
}

// ---- why there is no plan ----

// Motions on coarse meshes that could not be refined do not show that there are none.
TEST(Conclusion, IsThatNothingConvergedWhereOnlyRefiningFailed) {
  const Problem problem = request(kMove + "method: trapezoidal\n");
  const auto concluded = [&](const std::vector<double>& minima, const std::vector<Relaxation>& relaxations) {
    Session session{SessionOptions{}};
    Findings found(problem);
    found.minima = minima;
    Plan plan;
    plan.infeasibility.emplace();
    plan.infeasibility->sentence = "no motion found keeps every limit";
    plan.infeasibility->relaxations = relaxations;
    conclude(found, session, plan);
    return plan;
  };
  const Plan refining_failed = concluded({1.0}, {});
  EXPECT_EQ(refining_failed.status, PlanStatus::kNotConverged);
  EXPECT_FALSE(refining_failed.infeasibility);
  EXPECT_THAT(refining_failed.reason, testing::HasSubstr("method: hermite-simpson"));
  EXPECT_EQ(concluded({}, {}).status, PlanStatus::kInfeasible);
  EXPECT_EQ(concluded({1.0}, {Relaxation{}}).status, PlanStatus::kInfeasible);
}

// What was refined and fails its certificate is told with what it fails by.
TEST(Conclusion, KeepsWhatACertificateRefused) {
  const Problem problem = request(kMove);
  Session session{SessionOptions{}};
  Findings found(problem);
  found.minima = {1.0};
  Plan plan;
  plan.status = PlanStatus::kUncertified;
  plan.reason = "torque of joint 1 reaches 13 N m";
  plan.infeasibility.emplace();
  plan.certificate.emplace();
  plan.certificate->limits.push_back({.name = "torque", .joint = 1, .limit = 12, .reached = 13, .passed = false});
  conclude(found, session, plan);
  EXPECT_EQ(plan.status, PlanStatus::kUncertified);
  EXPECT_EQ(plan.reason, "torque of joint 1 reaches 13 N m");
  EXPECT_TRUE(plan.certificate);
}

}  // namespace
}  // namespace fjr
