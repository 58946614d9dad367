// Trajectories that are not what they say: however small the lie, what is proven of it is true. Truth is what an arm
// and an integrator that share nothing with the program find (support/independent_arm.h).
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "common/input_error.h"
#include "planner/certificate/amplification.h"
#include "planner/certificate/proof/prove.h"
#include "planner/certificate/thresholds.h"
#include "planner/control/motor_feedback.h"
#include "planner/results/verification.h"
#include "support/exact_trajectories.h"
#include "support/independent_arm.h"

namespace fjr {
namespace {

using independent::Arm;
using independent::errors_of;
using testing::HasSubstr;

constexpr double kDuration = 0.06;  // [s]
constexpr double kMiss = 1e-9;      // [rad] what may not be missed

// Short, and through the steep friction of both motors.
const Trajectory& honest() {
  static const Trajectory trajectory = exact_trajectory(
      [](double t) {
        const double s = std::sin(2 * std::numbers::pi * t / 0.05);
        return Joints<double>{5 * s + 0.7, 2 * s};
      },
      kDuration, 1e-3);
  return trajectory;
}

// A way to lie, by more or less; 0 is the truth.
struct Lie {
  const char* name;
  std::function<void(double size, Trajectory&, Parameters&)> tell;
  double first;  // size to begin the search with
};

double bell(double t) { return std::pow(std::sin(std::numbers::pi * t / kDuration), 2); }
double bell_rate(double t) { return std::numbers::pi / kDuration * std::sin(2 * std::numbers::pi * t / kDuration); }

std::vector<Lie> lies() {
  std::vector<Lie> all;
  const auto add = [&](const char* name, double first, auto tell) { all.push_back({name, tell, first}); };
  using T = Trajectory&;
  using P = Parameters&;
  add("link 1 bulges", 1e-4, [](double e, T t, P) {
    for (Sample& row : t.samples) {
      row.state.q[0] += e * bell(row.time);
      row.state.dq[0] += e * bell_rate(row.time);
    }
  });
  add("link 2 bulges the other way", 1e-4, [](double e, T t, P) {
    for (Sample& row : t.samples) {
      row.state.q[1] -= e * bell(row.time);
      row.state.dq[1] -= e * bell_rate(row.time);
    }
  });
  add("one position", 1e-4, [](double e, T t, P) { t.samples[41].state.q[1] += e; });
  add("one velocity", 0.1, [](double e, T t, P) { t.samples[31].state.dq[0] += e; });
  add("all torque of motor 1", 1e-3, [](double e, T t, P) {
    for (Sample& row : t.samples) row.torque[0] *= 1 + e;
  });
  add("an offset of motor 2's torque", 1e-2, [](double e, T t, P) {
    for (Sample& row : t.samples) row.torque[1] -= e;
  });
  add("one torque", 1, [](double e, T t, P) { t.samples[20].torque[1] += e; });
  add("where motor 1 starts", 1e-3, [](double e, T t, P) { t.samples[0].state.theta[0] += e; });
  add("how quickly link 2 starts", 1e-3, [](double e, T t, P) { t.samples[0].state.dq[1] += e; });
  add("the clock", 1e-4, [](double e, T t, P) {
    for (Sample& row : t.samples) row.time *= 1 + e;
  });
  add("the spring of joint 1", 1e-3, [](double e, T, P p) { p.spring.stiffness[0] *= 1 + e; });
  add("the friction of joint 2", 1e-3, [](double e, T, P p) { p.friction.amplitude[1] *= 1 + e; });
  add("the step of joint 1's friction", 1e-3, [](double e, T, P p) { p.friction.second_weight[0] *= 1 + e; });
  add("the payload", 1e-2, [](double e, T, P p) { p.payload = {e, e * 1e-3}; });
  return all;
}

struct Told {
  Trajectory trajectory = honest();
  Parameters robot = fjr::robot();

  Told(const Lie& lie, double size) { lie.tell(size, trajectory, robot); }
  independent::Errors errors(bool closed) const { return errors_of({robot}, trajectory, closed); }
};

// The size of a lie of which `error` comes to `wanted`, within a tenth of kMiss, by the secant method: errors grow in
// proportion, or nearly.
double size_for(const Lie& lie, const std::function<double(const Told&)>& error, double wanted) {
  double a = 0, of_a = error(Told(lie, 0)), b = lie.first, of_b = error(Told(lie, b));
  for (int i = 0; i < 20 && !(std::abs(of_b - wanted) < 0.1 * kMiss); ++i) {
    const double next = b + (wanted - of_b) * (b - a) / (of_b - of_a);
    a = b;
    of_a = of_b;
    b = next;
    of_b = error(Told(lie, b));
  }
  EXPECT_NEAR(of_b, wanted, 0.1 * kMiss) << lie.name;
  return b;
}

class Lies : public testing::TestWithParam<Lie> {};
INSTANTIATE_TEST_SUITE_P(, Lies, testing::ValuesIn(lies()), [](const auto& lie) {
  std::string name = lie.param.name;
  std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
  return name;
});

TEST(ExactMotion, NeedsNeitherStretchesNorDither) {
  EXPECT_TRUE(PlannedDither(robot(), honest()).steps().empty());
  EXPECT_TRUE(stretches_of_amplification(robot(), honest()).empty());
  // Two models, two integrators; 6e-10 rad are between rows, where a motion is no cubic.
  EXPECT_LT(static_cast<double>(errors_of({robot()}, honest(), false).link), 1e-9);
  EXPECT_TRUE(prove(robot(), robot_limits(), {}, honest()).proven);
}

// Three rows within 2 us, of which the one in the middle says that motor 1 is faster by `more` [rad/s] than it is.
Trajectory with_a_false_velocity(double more) {
  Trajectory lie = reference_trajectory();
  Interpolator rows(reference_trajectory());
  std::vector<Sample> told{rows.at(0.2), rows.at(0.2 + 1e-6), rows.at(0.2 + 2e-6)};
  told[1].state.dtheta[0] += more;
  const auto at = std::find_if(lie.samples.begin(), lie.samples.end(), [](const Sample& r) { return r.time > 0.1995; });
  lie.samples.insert(lie.samples.erase(at), told.begin(), told.end());
  return lie;
}

// Nothing moves less than it says: the means of the velocities are right. But a motor that creeps could say in such
// rows that it goes the other way, and hide that its torque jumps by twice its friction.
TEST(Certificate, AVelocityThatJumpsToAndFroIsNotCertified) {
  for (const double honest : {0.0, 1e-3})
    EXPECT_TRUE(certificate_of(with_a_false_velocity(honest)).certified) << honest;
  for (const double lie : {-5e-3, 5e-3}) {
    const Certificate c = certificate_of(with_a_false_velocity(lie));
    ASSERT_EQ(c.failures.size(), 1U);
    EXPECT_THAT(c.failures[0], HasSubstr("dtheta1 changes by 5.00e-03 rad/s until 0.20000"));
  }
}

// The columns of motor 1 belong together, and to no motion of it: for 0.1 s it is said to be up to 0.0085 rad/s faster
// or slower than the torque moves it.
TEST(Certificate, AMotorThatMovesOtherwiseThanItSaysIsNotCertified) {
  Trajectory lie = reference_trajectory();
  for (Sample& row : lie.samples) {
    const double phase = 2 * std::numbers::pi * std::clamp((row.time - 0.2) / 0.1, 0.0, 1.0);
    row.state.theta[0] += 0.0085 * 0.1 / (2 * std::numbers::pi) * (1 - std::cos(phase));
    row.state.dtheta[0] += 0.0085 * std::sin(phase);
  }
  const Certificate c = certificate_of(lie);
  ASSERT_EQ(c.failures.size(), 1U);
  EXPECT_THAT(c.failures[0], HasSubstr("closed loop: the velocity of motor 1 is up to"));
  const Proof proof = prove(robot(), robot_limits(), {}, lie);
  EXPECT_THAT(proof.reason, HasSubstr("closed loop: the velocity of motor 1 may be"));
}

// In open loop one nanoradian decides, from either side.
TEST_P(Lies, BeyondTheLimitByOneNanoradianAreNeverProven) {
  const double count = exactness_tolerance(robot());
  const auto error = [](const Told& told) { return static_cast<double>(told.errors(false).link); };
  const Told wrong(GetParam(), size_for(GetParam(), error, count + kMiss)),
      right(GetParam(), size_for(GetParam(), error, count - kMiss));
  EXPECT_FALSE(prove(wrong.robot, robot_limits(), {}, wrong.trajectory).open_loop.proven);
  const Proof proof = prove(right.robot, robot_limits(), {}, right.trajectory);
  EXPECT_TRUE(proof.open_loop.proven) << proof.open_loop.reason;
}

// In closed loop the feedback that it takes decides, or what is left of the errors.
TEST_P(Lies, ThatTakeMoreFeedbackThanAllowedAreNotProven) {
  const double count = exactness_tolerance(robot()), velocity = rollout_velocity_tolerance(robot());
  const Joints<double> motor = rollout_motor_velocity_tolerance(robot()), feedback = feedback_limit(robot());
  // As a fraction of what is allowed, in the size of a count.
  const auto error = [&](const Told& told) {
    const independent::Errors e = told.errors(true);
    return count * static_cast<double>(std::max({e.link / count, e.link_velocity / velocity,
                                                 e.motor_velocity[0] / motor[0], e.motor_velocity[1] / motor[1],
                                                 e.feedback[0] / feedback[0], e.feedback[1] / feedback[1]}));
  };
  const Told wrong(GetParam(), size_for(GetParam(), error, count + kMiss));
  EXPECT_FALSE(prove(wrong.robot, robot_limits(), {}, wrong.trajectory).closed_loop.proven);
}

// ---- files ----

Trajectory published(const Trajectory& rows) {
  Trajectory trajectory = rows;
  trajectory.metadata = {{"rows", std::to_string(rows.samples.size())},
                         {"payload", "0 kg"},
                         {"limits.torque[0]", "11 N m"},
                         {"robot_hash", robot_hash(robot())}};
  return trajectory;
}

// A line of the file, or a part of it, tampered with.
class Forger {
 public:
  explicit Forger(unsigned seed) : random_(seed) {}

  std::string forge(const std::string& file) {
    std::vector<std::string> lines;
    std::istringstream in(file);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    const auto header = static_cast<std::size_t>(
        std::find_if(lines.begin(), lines.end(), [](const std::string& l) { return l.starts_with("time"); }) -
        lines.begin());
    const std::size_t row = header + 1 + below(lines.size() - header - 1);
    switch (below(6)) {
      case 0:
        lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(row), lines[row]);
        break;
      case 1:
        std::swap(lines[row], lines[header + 1 + below(lines.size() - header - 1)]);
        break;
      case 2:
        lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(row));
        break;
      case 3:
        lines[below(header)] = any_header();
        break;
      default:
        replace_number(lines[row]);
    }
    std::string text;
    for (const std::string& line : lines) text += line + '\n';
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }

  std::string any_header() {
    const std::vector<std::string> headers{"# payload: 0.05 kg",
                                           "# payload: -1 kg",
                                           "# payload: nan kg",
                                           "# limits.torque[0]: 3 N m",
                                           "# limits.torque[0]: 1e9 N m",
                                           "# limits.torque[1]: nan N m",
                                           "# limits.motor_velocity[0]: 0 rad/s",
                                           "# limits.tip_speed: 1e-3 m/s",
                                           "# rows: 3",
                                           "# rows: 1e9"};
    return headers[below(headers.size())];
  }
  void replace_number(std::string& line) {
    std::vector<std::string> cells;
    std::istringstream in(line);
    for (std::string text; std::getline(in, text, ',');) cells.push_back(text);
    std::string& text = cells[below(cells.size())];
    const std::vector<std::string> odd{"nan",   "inf",   "-inf", "1e308", "-1e308", "5e-324", "1e-320", "-0",
                                       "1e999", "0x1p3", "",     "1e280", "1e150",  "1e-200", "0"};
    const double value = std::stod(text);
    const double off = std::pow(10.0, -static_cast<double>(below(12)));
    text = below(2) == 0 ? odd[below(odd.size())] : fmt::format("{:.17g}", below(2) == 0 ? value + off : value - off);
    line.clear();
    for (const std::string& c : cells) line += (line.empty() ? "" : ",") + c;
  }

  std::mt19937 random_;
};

// Whether the exact motion is what the rows say, as far as a certificate promises: by the independent arm, and by
// looking at the rows 40 times between each two.
bool is_true(const Verification& v, const Trajectory& trajectory) {
  constexpr double kCompared = 1e-12;  // [rad] by which two integrators may differ
  const double count = exactness_tolerance(v.robot);
  const Arm arm{v.robot};
  const auto open = errors_of(arm, trajectory, false), closed = errors_of(arm, trajectory, true);
  if (!(open.link <= count + kCompared && closed.link <= count + kCompared)) return false;
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!(closed.feedback[j] <= feedback_limit(v.robot)[j] + 1e-9)) return false;
  }
  for (std::size_t k = 0; k + 1 < trajectory.samples.size(); ++k) {
    const independent::Between rows{trajectory.samples[k], trajectory.samples[k + 1]};
    for (int i = 0; i <= 40; ++i) {
      const auto t = rows.length() * i / 40;
      const auto x = rows.state(t);
      const auto tau = rows.torque(t);
      for (std::size_t j = 0; j < kJoints; ++j) {
        const bool kept = std::abs(tau[j]) <= v.limits.torque[j] * (1 + kPublishedFraction) &&
                          std::abs(x[6 + j]) <= v.limits.motor_velocity[j] * (1 + kPublishedFraction) &&
                          std::abs(x[j]) <= v.limits.link_position[j] * (1 + kPublishedFraction) &&
                          std::abs(x[4 + j] - x[j]) <= v.limits.spring_deflection[j] * (1 + kPublishedFraction);
        if (!kept) return false;
      }
    }
  }
  return true;
}

TEST(Files, ThatWereTamperedWithAreRefusedOrTrueAllTheSame) {
  std::ostringstream file;
  format_csv(published(honest()), file);
  const char* const more = std::getenv("FJR_LIES");  // of them; for a longer look
  const unsigned count = more == nullptr ? 60 : static_cast<unsigned>(std::stoul(more));
  unsigned unreadable = 0, refused = 0, proven = 0;
  for (unsigned seed = 0; seed < count; ++seed) {
    std::istringstream forged(Forger(seed).forge(file.str()));
    SCOPED_TRACE(seed);
    try {
      const Trajectory trajectory = parse_csv(forged, "forged.csv");
      const Verification v = verify(trajectory, "forged.csv", robot(), {std::nullopt, true});
      ++(v.certificate.certified ? proven : refused);
      if (!v.certificate.proof.proven) continue;
      EXPECT_TRUE(is_true(v, trajectory)) << forged.str();
    } catch (const InputError&) {
      ++unreadable;
    }
  }
  EXPECT_GT(unreadable, count / 20);  // or nothing would be tested
  EXPECT_GT(refused, count / 20);
  EXPECT_GT(proven, count / 20);
  RecordProperty("unreadable, refused, proven", fmt::format("{}, {}, {}", unreadable, refused, proven));
}

}  // namespace
}  // namespace fjr
