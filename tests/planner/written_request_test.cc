// Requests that are written and read again, their hashes, and texts that are damaged.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <regex>
#include <string>
#include <vector>

#include "planner/request/keys.h"
#include "planner/request/request_keys.h"
#include "tests/planner/parsed_request.h"
#include "tests/support/mutated_text.h"
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

// Two requests that differ in the value of one key alone: @ in their text stands for it.
struct ChangedKey {
  std::string key, text, value, other;

  std::string having(const std::string& with) const {
    std::string yaml = text;
    return yaml.replace(yaml.find('@'), 1, with);
  }
  std::string hash(const std::string& with) const {
    try {
      return parse(having(with)).request_hash;
    } catch (const InputError& error) {
      ADD_FAILURE() << key << ": " << with << " is refused: " << error.what();
      return "";
    }
  }
  // Returns whether @ is the value of that key.
  bool is_of_its_key() const {
    const std::size_t dot = key.rfind('.');
    const std::string own = key.substr(dot + 1);  // also if there is no dot
    const std::size_t at = text.find(own + ": @");
    if (at == std::string::npos || (at > 0 && std::isalpha(static_cast<unsigned char>(text[at - 1])) != 0))
      return false;
    if (dot == std::string::npos) return true;
    const std::string section = key.substr(0, key.find_first_of(".["));
    return text.rfind(section + ":", at) != std::string::npos;
  }
};

const std::string kUncertain = "payload: {mass: {value: 0.1, unit: kg, standard_error: 0.01}}\n";
const std::string kVia = "via: [{q: [0.5, -0.4]}]\n";

std::vector<ChangedKey> changed_terms() {
  std::vector<ChangedKey> changed;
  for (const TermInfo& term : Terms::infos) {
    const std::string name = term.name, beside = name == "time" ? "effort" : "time";
    changed.push_back({"objective." + name,
                       kMove + kUncertain + kVia + "objective: {" + beside + ": 1, " + name + ": @}\n", "1", "2"});
  }
  return changed;
}

std::vector<ChangedKey> changed_limits() {
  const Limits robots = Limits::of(load_parameters(kRobot));
  std::vector<ChangedKey> changed;
  for (const QuantityInfo& limit : Quantities::infos) {
    const auto tightened = [&](double fraction) {
      const auto of = [&](std::size_t j) {
        return std::to_string(fraction * (limit.of_robot ? limit.in(robots, j) : 100));
      };
      return limit.of_tip ? of(0) : "[" + of(0) + ", " + of(1) + "]";
    };
    const std::string name = limit.name;
    changed.push_back({"limits." + name, kStart + "goal: {q: [0.2, -0.1]}\nlimits: {" + name + ": @}\n", tightened(0.9),
                       tightened(0.8)});
  }
  return changed;
}

std::vector<ChangedKey> changed_regions() {
  const std::string ends = "from: [0, -0.65], to: [0.45, -0.42]", line = kMove + "tip: {line: {",
                    arc = kMove + "tip: {arc: {", center = "center: [0, 0], ";
  return {
      {"tip", kMove + "tip: @\n", "{line: {" + ends + ", tolerance: 0.9}}", "{box: [[-0.7, -0.7], [0.7, 0.7]]}"},
      {"tip.box", kMove + "tip: {box: @}\n", "[[-0.7, -0.7], [0.7, 0.7]]", "[[-0.7, -0.7], [0.7, 0.6]]"},
      {"tip.line", kMove + "tip: {line: @}\n", "{" + ends + ", tolerance: 1}", "{" + ends + ", tolerance: 0.9}"},
      {"tip.line.from", line + "from: @, to: [0.45, -0.42], tolerance: 1}}\n", "[0, -0.65]", "[0, -0.6]"},
      {"tip.line.to", line + "from: [0, -0.65], to: @, tolerance: 1}}\n", "[0.45, -0.42]", "[0.47, -0.42]"},
      {"tip.line.tolerance", line + ends + ", tolerance: @}}\n", "1", "0.9"},
      {"tip.arc", kMove + "tip: {arc: @}\n", "{" + center + ends + ", tolerance: 0.1}",
       "{" + center + ends + ", tolerance: 0.09}"},
      {"tip.arc.center", arc + "center: @, " + ends + ", tolerance: 0.1}}\n", "[0, 0]", "[0.01, 0]"},
      {"tip.arc.from", arc + center + "from: @, to: [0.45, -0.42], tolerance: 0.1}}\n", "[0, -0.65]", "[-0.1, -0.64]"},
      {"tip.arc.to", arc + center + "from: [0, -0.65], to: @, tolerance: 0.1}}\n", "[0.45, -0.42]", "[0.47, -0.42]"},
      {"tip.arc.tolerance", arc + center + ends + ", tolerance: @}}\n", "0.1", "0.09"},
      {"tip.arc.way", arc + center + ends + ", tolerance: 0.1, way: @}}\n", "short", "long"}};
}

std::vector<ChangedKey> changed_keys() {
  const std::string moving = kStart + "goal: {q: [1.2, -0.8], dq: [1, 0], ",
                    tip = kStart + "goal: {tip: ", timed = kMove + "duration: 1\n";
  const std::string config = std::string(FJR_SOURCE_DIR) + "/config/";
  std::vector<ChangedKey> changed{
      {"robot", kStart + "goal: {q: [0.1, 0.1]}\nrobot: @\n", config + "robot.yaml", config + "robots/asr_twodof.yaml"},
      {"start", "start: @\n" + kGoal, "{q: [0, 0]}", "{q: [0.1, 0]}"},
      {"start.q", "start: {q: @}\n" + kGoal, "[0, 0]", "[0, 0.1]"},
      {"start.dq", "start: {q: [0, 0], dq: @}\n" + kGoal, "[0.1, 0]", "[0.1, 0.1]"},
      {"start.theta", "start: {q: [0, 0], theta: @}\n" + kGoal, "[0, 0]", "[0.01, 0]"},
      {"start.dtheta", "start: {q: [0, 0], dtheta: @}\n" + kGoal, "[0, 0]", "[0, 0.1]"},
      {"goal", kStart + "goal: @\n", "{q: [1.2, -0.8]}", "{tip: [0.3, -0.4]}"},
      {"goal.q", kStart + "goal: {q: @}\n", "[1.2, -0.8]", "[1.2, free]"},
      {"goal.dq", kStart + "goal: {q: [1.2, -0.8], dq: @}\n", "[1, 0]", "free"},
      {"goal.theta", moving + "theta: @}\n", "[1.2, -0.8]", "[1.2, -0.81]"},
      {"goal.dtheta", moving + "dtheta: @}\n", "[1, 0]", "[1, 0.1]"},
      {"goal.tip", tip + "@}\n", "[0.3, -0.4]", "[0.3, -0.41]"},
      {"goal.elbow", tip + "[0.3, -0.4], elbow: @}\n", "any", "left"},
      {"goal.tip_velocity", tip + "[0.3, -0.4], tip_velocity: @}\n", "[0.1, 0]", "[0.1, 0.1]"},
      {"duration", kMove + "duration: @\n", "1", "1.5"},
      {"duration.min", kMove + "duration: {min: @}\n", "0.3", "0.4"},
      {"duration.max", kMove + "duration: {max: @}\n", "3", "4"},
      {"objective", kMove + "objective: @\n", "fastest", "efficient"},
      {"via", kMove + "via: @\n", "[]", "[{q: [0.5, -0.4]}]"},
      {"via[].time", timed + "via: [{time: @, q: [0.5, -0.4]}]\n", "0.5", "0.6"},
      {"via[].q", kMove + "via: [{q: @}]\n", "[0.5, -0.4]", "[0.5, -0.3]"},
      {"via[].dq", kMove + "via: [{q: [0.5, -0.4], dq: @}]\n", "[0, 0]", "[0.1, 0]"},
      {"via[].release", kMove + "via: [{q: [0.5, -0.4], release: @}, {q: [0.6, -0.4]}]\n", "false", "true"},
      {"obstacles", kMove + "obstacles: @\n", "[]", "[{center: [2, 2], radius: 0.1}]"},
      {"obstacles[].center", kMove + "obstacles: [{center: @, radius: 0.1}]\n", "[2, 2]", "[2, 3]"},
      {"obstacles[].radius", kMove + "obstacles: [{center: [2, 2], radius: @}]\n", "0.1", "0.2"},
      {"obstacles[].margin", kMove + "obstacles: [{center: [2, 2], radius: 0.1, margin: @}]\n", "0", "0.2"},
      {"walls", kMove + "walls: @\n", "[]", "[{point: [0, -2], normal: [0, 1]}]"},
      {"walls[].point", kMove + "walls: [{point: @, normal: [0, 1]}]\n", "[0, -2]", "[0, -3]"},
      {"walls[].normal", kMove + "walls: [{point: [0, -2], normal: @}]\n", "[0, 1]", "[0.1, 1]"},
      {"walls[].margin", kMove + "walls: [{point: [0, -2], normal: [0, 1], margin: @}]\n", "0", "0.1"},
      {"path", kMove + "path: @\n", "{points: [], tolerance: 0.05}", "{points: [[0.5, -0.4]], tolerance: 0.05}"},
      {"path.points", kMove + "path: {points: @, tolerance: 0.05}\n", "[[0.5, -0.4]]", "[[0.5, -0.3]]"},
      {"path.tolerance", kMove + "path: {points: [[0.5, -0.4]], tolerance: @}\n", "0.05", "0.06"},
      {"limits", kMove + "limits: @\n", "{tip_speed: 9}", "{motor_power: [90, 90]}"},
      {"sample_period", kMove + "sample_period: @\n", "0.001", "0.002"},
      {"seed", kMove + "seed: @\n", "1", "2"},
      {"payload", kMove + "payload: @\n", "0.1", "{mass: 0.1, inertia: 0.001}"},
      {"method", kMove + "method: @\n", "hermite-simpson", "radau3"},
      {"search", kMove + "search: @\n", "default", "thorough"},
      {"robust", kMove + kUncertain + "robust: @\n", "{confidence: 0.9}", "{confidence: 0.95}"},
      {"robust.confidence", kMove + kUncertain + "robust: {confidence: @}\n", "0.9", "0.95"},
      {"proven", kMove + "proven: @\n", "false", "true"}};
  for (const auto& more : {changed_terms(), changed_limits(), changed_regions()}) {
    changed.insert(changed.end(), more.begin(), more.end());
  }
  return changed;
}

// Each key may change the plan, so a library or an earlier batch must not take the plan of another value for it.
TEST(RequestHash, DependsOnEveryKey) {
  const std::vector<ChangedKey> changed = changed_keys();
  for (const ChangedKey& of : changed) {
    EXPECT_TRUE(of.is_of_its_key()) << of.key << " has another value in " << of.text;
    EXPECT_NE(of.hash(of.value), of.hash(of.other)) << "the hash does not depend on " << of.key;
  }
  for (const KeyLine& line : all_keys()) {
    EXPECT_TRUE(std::any_of(changed.begin(), changed.end(), [&](const ChangedKey& of) { return of.key == line.name; }))
        << "no request here has another value of " << line.name;
  }
}

// The list of keys says which values are allowed: they are those that requests are not refused for.
TEST(Keys, SayWhichValuesAreAllowed) {
  const std::regex range("(?:([0-9.e-]+) to |up to )([0-9.e-]+)(?:;.*)?");
  const auto is_outside = [](const ChangedKey& of, const KeyLine& line, double value) {
    const bool is_pair = of.value.front() == '[';
    const std::string name = std::regex_replace(of.key, std::regex(R"(\[\])"), "[0]") + (is_pair ? "[0]" : "");
    const std::string error = error_of(of.having(is_pair ? fmt::format("[{}, 0]", value) : fmt::format("{}", value)));
    if (error.find("is outside [") == std::string::npos) return false;
    EXPECT_TRUE(error.starts_with(fmt::format("request.yaml: {}: ", name))) << error << ", " << line.allowed;
    return true;
  };
  int ranges = 0;
  const std::vector<ChangedKey> changed = changed_keys();
  for (const KeyLine& line : all_keys()) {
    std::smatch found;
    if (!std::regex_match(line.allowed, found, range)) continue;
    ++ranges;
    const auto of =
        std::find_if(changed.begin(), changed.end(), [&](const ChangedKey& c) { return c.key == line.name; });
    ASSERT_NE(of, changed.end()) << line.name;
    const double most = std::stod(found[2]), least = found[1].matched ? std::stod(found[1]) : -most;
    for (const double allowed : {least, most})
      EXPECT_FALSE(is_outside(*of, line, allowed)) << line.name << ": " << allowed;
    const double beyond = 1e-6 * most;
    EXPECT_TRUE(is_outside(*of, line, least - beyond)) << line.name << ": " << line.allowed;
    EXPECT_TRUE(is_outside(*of, line, most + beyond)) << line.name << ": " << line.allowed;
  }
  EXPECT_GE(ranges, 20);
}

// There is no key without influence; but some values of a key mean the same.
TEST(RequestHash, IsTheSameForValuesThatMeanTheSame) {
  const std::string config = std::string(FJR_SOURCE_DIR) + "/config/";
  const std::vector<ChangedKey> same{
      // The values in a robot's file count, and not where it is.
      {"robot", kMove + "robot: @\n", config + "robot.yaml", config + "robots/../robot.yaml"},
      // It gives a direction alone.
      {"walls[].normal", kMove + "walls: [{point: [0, -2], normal: @}]\n", "[0, 1]", "[0, 200]"},
      // The last via point is where a motion to a rest releases anyway.
      {"via[].release", kMove + "via: [{q: [0.5, -0.4], release: @}]\n", "false", "true"},
      // How well a payload is known matters to robust motions and to `tracking` alone.
      {"payload", kMove + "payload: {mass: @}\n", "0.1", "{value: 0.1, unit: kg, standard_error: 0.01}"}};
  for (const ChangedKey& of : same) EXPECT_EQ(of.hash(of.value), of.hash(of.other)) << of.key;
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
