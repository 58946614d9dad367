// Requests that are written and read again, their hashes, and texts that are damaged.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "planner/request/keys.h"
#include "planner/request/request_keys.h"
#include "tests/planner/parsed_request.h"
#include "tests/support/random_requests.h"

namespace fjr {
namespace {

// A request as a document of one line is the same request, to the last bit, whatever it asks for.
void expect_same_when_written(const Request& request, const Parameters& robot) {
  const std::string text = format_request(request);
  Request again = read_request(YamlNode::parse(text, request.source));
  EXPECT_EQ(format_request(again), text);
  EXPECT_EQ(resolve(again, robot).request_hash, resolve(request, robot).request_hash) << text;
}

TEST(Request, IsTheSameWhenItIsWrittenAndReadAgain) {
  const Parameters robot = load_parameters(kRobot);
  for (const std::filesystem::directory_entry& example :
       std::filesystem::directory_iterator(std::filesystem::path(FJR_SOURCE_DIR) / "config/requests")) {
    expect_same_when_written(read_request(YamlNode::load(example.path())), robot);
  }
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    expect_same_when_written(read(random_request(robot, seed).yaml), robot);
  }
  for (const char* more :
       {"tip: {arc: {center: [0, 0], from: [0.3, 0.52], to: [0.6, 0], tolerance: 0.01, way: long}}",
        "limits: {torque: [10, 4], tip_speed: 2.5}", "payload: {mass: 0.1, inertia: 0.001}",
        "objective: {time: 1, copper: 0.1}", "duration: {max: 3}", "method: radau3", "search: quick", "seed: 7",
        "payload: {mass: {value: 0.1, unit: kg, standard_error: 0.01}, inertia: 0.001}"}) {
    const Request request = read(kMove + more + "\n");
    EXPECT_EQ(format_request(read(format_request(request))), format_request(request)) << more;
    EXPECT_NE(format_request(request), format_request(read(kMove))) << more;
  }
}

// Where there is a choice of one thing: nothing of the earlier choice is left, neither in the problem nor on the wire.
TEST(Request, OneMemberThatIsSetCountsWhateverWasThereBefore) {
  const Parameters robot = load_parameters(kRobot);
  Request request = read(kMove + "objective: efficient\ntip: {box: [[-0.7, -0.7], [0.7, 0.7]]}\n");
  request.objective = Weights{.time = 2, .energy = 3};
  std::get<JointGoal>(request.goal).arrival = AnyVelocity{};
  request.tip = TipLine{{0, -0.65}, {0.5, 0.3}, 0.9};
  for (const Request& same : {request, read(format_request(request))}) {
    const Problem problem = resolve(same, robot);
    expect_weights(problem.weights, 2, 0, 0, 0);
    EXPECT_EQ(problem.weights.energy, 3);
    EXPECT_TRUE(problem.goal.dq_free);
    EXPECT_FALSE(problem.goal.at_rest);
    EXPECT_FALSE(problem.task.box);
    EXPECT_TRUE(problem.task.line);
  }
  request.objective = Preset::kGentle;
  std::get<JointGoal>(request.goal).arrival = Moving{{0.5, 0}, {}, {}};
  const Problem problem = resolve(request, robot);
  expect_weights(problem.weights, 1, 0.01, 0, 1e-3);
  EXPECT_FALSE(problem.goal.dq_free);
  EXPECT_EQ(problem.goal.dq, (Joints<double>{0.5, 0}));
}

// What is set in place of something else leaves nothing of it: not a velocity of the tip beside angles, not via points
// beside a path, not a bound beside a duration.
TEST(Request, OneKindTakesThePlaceOfAnother) {
  const Parameters robot = load_parameters(kRobot);
  Request request = read(
      "start: {q: [0, 0]}\ngoal: {tip: [0.3, -0.4], elbow: left, tip_velocity: [0.1, 0]}\n"
      "duration: {min: 0.5, max: 9}\nvia: [{q: [0.1, 0.1], release: true}]\n");
  request.goal = JointGoal{{1.2, -0.8}, AtRest{}};
  request.way = RequestedPath{{{0.5, -0.5}}, 0.05};
  request.duration = 2.0;
  EXPECT_EQ(
      format_request(request),
      "{start: {q: [0, 0]}, goal: {q: [1.2, -0.8]}, duration: 2, path: {points: [[0.5, -0.5]], tolerance: 0.05}}");
  for (const Request& same : {request, read(format_request(request))}) {
    const Problem problem = resolve(same, robot);
    EXPECT_TRUE(problem.goal.at_rest);
    EXPECT_TRUE(problem.other_goals.empty());
    EXPECT_TRUE(problem.task.path);
    EXPECT_FALSE(problem.release);
    EXPECT_TRUE(problem.duration.fixed());
  }
  request.goal = TipGoal{{0.3, -0.4}, Elbow::kLeft, {}};
  request.way = std::vector{RequestedVia{.q = {0.1, 0.1}, .dq = {}}};
  request.duration = FreeDuration{.min = {}, .max = 3};
  EXPECT_EQ(format_request(request),
            "{start: {q: [0, 0]}, goal: {tip: [0.3, -0.4], elbow: left}, duration: {max: 3}, via: [{q: [0.1, 0.1]}]}");
}

TEST(Request, AStartThatSaysNothingIsLeftOut) {
  for (const char* start : {"", "start:\n", "start: {}\n", "start: null\n"}) {
    EXPECT_FALSE(read(start + kGoal).start) << start;
  }
  EXPECT_TRUE(read(kMove).start);
}

TEST(RequestHash, DependsOnWhatIsMeantAndNotOnHowItIsWritten) {
  const std::string plain = parse(kMove).request_hash;
  EXPECT_EQ(plain.size(), 64U);
  EXPECT_EQ(parse("# hello\nseed: 1\nobjective: {time: 1.0}\ngoal: {q: [12e-1, -0.80]}\n"
                  "start: {q: [0, -0.0], dq: [0, 0]}\nduration: free\nlimits: {torque: [12, 5]}")
                .request_hash,
            plain);
  const std::vector<std::string> others{
      kMove + "seed: 2",
      kMove + "sample_period: 0.002",
      kMove + "objective: gentle",
      kMove + "duration: {max: 3}",
      kMove + "duration: {min: 0.3}",
      kMove + "limits: {torque: [11, 5]}",
      kMove + "limits: {torque_rate: [100, 100]}",
      kMove + "limits: {tip_speed: 9}",
      kMove + "duration: 1",
      kMove + "duration: 1\nvia: [{time: 0.5, q: [0, 0]}]",
      kMove + "duration: 1\nvia: [{time: 0.6, q: [0, 0]}]",
      kMove + "duration: 1\nvia: [{time: 0.6, q: [0, 0], dq: [0, 0]}]",
      kStart + "goal: {q: [1.2, -0.8], dq: [1, 0]}",
      kStart + "goal: {q: [1.2, -0.8], dq: [1, 0], theta: [1.2, -0.8]}",
      kStart + "goal: {q: [1.2, -0.8], dq: [1, 0], dtheta: [1, 0]}",
      kStart + "goal: {q: [1.2, -0.8000000000000002]}",
      "start: {q: [0, 0], dtheta: [0.1, 0]}\n" + kGoal,
      "start: {q: [0, 0], dq: [0.1, 0]}\n" + kGoal,
  };
  std::vector<std::string> seen{plain};
  for (const std::string& yaml : others) {
    seen.push_back(parse(yaml).request_hash);
    for (std::size_t i = 0; i + 1 < seen.size(); ++i) EXPECT_NE(seen.back(), seen[i]) << yaml;
  }
}

// A valid Problem promises what the planner relies on, whatever text it came from.
void expect_sound(const Problem& p) {
  for (int i = 0; i < kStates; ++i) EXPECT_TRUE(std::isfinite(p.start[i]));
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_LE(std::abs(p.goal.q[j]), p.limits.link_position[j]);
    EXPECT_LE(p.limits.torque[j], p.robot.limits.torque[j]);
    EXPECT_LE(std::abs(p.start.theta[j] - p.start.q[j]), p.limits.spring_deflection[j]);
    EXPECT_LE(std::abs(p.start.dtheta[j]), p.limits.motor_velocity[j]);
  }
  EXPECT_LE(p.duration.min, p.duration.max);
  EXPECT_TRUE(p.duration.fixed() || p.weights.time > 0);
  EXPECT_TRUE(!p.goal.at_rest || (p.goal.theta && p.goal.dtheta));
  for (std::size_t i = 0; i < p.via.size(); ++i) EXPECT_GT(p.via[i].time, i == 0 ? 0 : p.via[i - 1].time);
}

std::string mutated(std::string text, std::mt19937& random) {
  static const std::string kBytes = "{}[],:-#&*!|>'\"%@`?0123456789e.~<=\n\t ";
  const int edits = 1 + static_cast<int>(random() % 3);
  for (int e = 0; e < edits && !text.empty(); ++e) {
    const std::size_t at = random() % text.size();
    switch (random() % 4) {
      case 0:
        text.erase(at, 1 + random() % 8);
        break;
      case 1:
        text.insert(at, 1, kBytes[random() % kBytes.size()]);
        break;
      case 2:
        text[at] = static_cast<char>(random() % 256);
        break;
      default:
        text.insert(at, text.substr(random() % text.size(), random() % 12));
        break;
    }
  }
  return text;
}

TEST(Request, MutatedTextsAreReadOrRefused) {
  const std::vector<std::string> valid{
      kMove, "start: {q: [0.0, 0.0], dq: [1, -1]}\ngoal: {q: [1.2, -0.8], dq: [0.5, 0], theta: [1.3, -0.8]}\nseed: 7\n",
      kMove +
          "duration: 1.5\nobjective: {effort: 1, torque_rate: 1e-4}\n"
          "via:\n  - {time: 0.5, q: [0.6, 0.4]}\n  - time: 0.8\n    q: [0.7, 0.4]\n    dq: [0, 0.1]\n",
      "# comment\nstart:\n  q: [0, 0]\ngoal:\n  q:\n    - 1.2\n    - -0.8\nduration: {min: 0.4, max: 2.0}\n"
      "objective: 'gentle'\nlimits: {torque: [10, 4], tip_speed: 3}\nsample_period: 0.002\n"};
  std::mt19937 random(11);
  int read = 0, refused = 0;
  for (int i = 0; i < 6000; ++i) {
    const std::string text = mutated(valid[static_cast<std::size_t>(i) % valid.size()], random);
    try {
      expect_sound(parse(text));
      ++read;
    } catch (const InputError& e) {
      EXPECT_FALSE(e.problem().empty());
      ++refused;
    } catch (const std::exception& e) {
      FAIL() << "round " << i << ": " << e.what() << "\n" << text;
    }
    ASSERT_FALSE(HasFailure()) << "round " << i << "\n" << text;
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refused, 3000);
}

}  // namespace
}  // namespace fjr
