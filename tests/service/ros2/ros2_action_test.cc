// `fjr ros2-action` and a client that knows ROS 2's definitions only (ros_client.h), with service and executor, each a
// process of its own.
#include <gmock/gmock.h>
#include <hostile_bytes.h>

#include <cmath>
#include <cstdlib>
#include <regex>

#include "tests/service/ros2/ros_client.h"
#include "tests/support/service_processes.h"

namespace fjr {
namespace {

using ros2_test::Client;
using ros2_test::Feedback;
using ros2_test::Goal;
using ros2_test::Result;
using ros2_test::Uuid;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kGoalTolerance = 0.005;  // [rad] the executor's own, config/executor.yaml

class Ros2ActionTest : public ServiceProcesses {
 protected:
  void SetUp() override {
    ServiceProcesses::SetUp();
    ::setenv("CYCLONEDDS_URI", "file://" FJR_SOURCE_DIR "/config/cyclonedds.xml", 0);  // the network that fjr is on
    service_ = serve();
    executor_ = fjr({"executor", "--start", "0.3,0.2", "--state", path("state")}, "executor.log");
    ASSERT_TRUE(comes_true([&] { return executor_->output().find("executing for") != std::string::npos; }, 30));
    client_ = std::make_unique<Client>(domain_);
    start_bridge({});
  }

  void start_bridge(std::vector<std::string> options) {
    options.insert(options.begin(), "ros2-action");
    bridge_ = fjr(options, "bridge.log");
    ASSERT_TRUE(comes_true([&] { return client_->server_is_available(); }, 30)) << bridge_->output();
  }
  void end_bridge() {
    bridge_->send(SIGTERM);
    EXPECT_EQ(bridge_->wait(), 0) << bridge_->output();
    ASSERT_TRUE(comes_true([&] { return !client_->server_is_available(); }));
  }

  Client& client() { return *client_; }
  Process& bridge() { return *bridge_; }

  // What the executor says of itself.
  struct Arm {
    std::string mode;
    std::vector<double> q;
  };
  Arm arm() const {
    const auto said = fjr({"status", "--json"}, "status.log");
    (void)said->wait();
    const std::string text = said->output();
    std::smatch mode, q;
    const bool found = std::regex_search(text, mode, std::regex("\"mode\": *\"(\\w+)\"")) &&
                       std::regex_search(text, q, std::regex("\"q\": *\\[\\s*([-+.e0-9]+),\\s*([-+.e0-9]+)"));
    EXPECT_TRUE(found) << text;
    return found ? Arm{mode[1], {std::stod(q[1]), std::stod(q[2])}} : Arm{"", {0, 0}};
  }

  // Sends the goal and waits until it is over.
  Result outcome(const Goal& goal) {
    const Uuid id = ros2_test::random_uuid();
    EXPECT_EQ(client().send(id, goal), true);
    return result(id);
  }
  Result result(const Uuid& id) {
    const auto came = client().result(id, 60);
    if (!came) ADD_FAILURE() << "no result";
    return came.value_or(Result{});
  }

  // The same goal again where the executor was kept from its ticks, which stops the arm and is the machine's fault.
  template <class Attempt>
  Result undisturbed(Attempt attempt) {
    Result result{};
    for (int i = 0; i < 5; ++i) {
      result = attempt();
      if (result.text.find("ticks in a row were missed") == std::string::npos) return result;
    }
    return result;
  }

  void wait_for_feedback_at(const Uuid& id, double time) {
    EXPECT_TRUE(comes_true(
        [&] {
          const auto all = client().take_feedback();
          return std::any_of(all.begin(), all.end(), [&](const Feedback& f) { return f.id == id && f.time > time; });
        },
        60));
  }

  const Process& executor() const { return *executor_; }

 private:
  std::unique_ptr<Process> service_, executor_, bridge_;
  std::unique_ptr<Client> client_;
};

Goal to(std::vector<double> positions, double time = 0) {
  Goal goal;
  goal.points.push_back({std::move(positions)});
  goal.points.back().time = time;
  return goal;
}

TEST_F(Ros2ActionTest, AGoalIsExecutedAndReported) {
  Uuid id{};
  Goal goal = to({-0.1, 0.6}, 1.0);
  goal.names = {"joint2", "joint1"};  // any order
  const Result result = undisturbed([&] {
    (void)client().take_feedback();
    id = ros2_test::random_uuid();
    EXPECT_EQ(client().send(id, goal), true);
    return this->result(id);
  });
  EXPECT_EQ(result.status, ros2_test::kSucceeded) << result.text;
  EXPECT_EQ(result.code, 0) << result.text;

  const std::vector<Feedback> feedback = client().take_feedback();
  // 1 s of motion and 0.5 s of watching the goal, at 10 Hz and more.
  ASSERT_GE(feedback.size(), 15U);
  double before = 0;
  for (const Feedback& one : feedback) {
    EXPECT_EQ(one.id, id);
    EXPECT_THAT(one.names, ElementsAre("joint2", "joint1"));
    EXPECT_GE(one.time, before);
    before = one.time;
    ASSERT_EQ(one.actual.size(), 2U);
    ASSERT_EQ(one.velocity.size(), 2U);
    for (std::size_t j = 0; j < 2; ++j) EXPECT_EQ(one.error[j], one.desired[j] - one.actual[j]);
  }
  EXPECT_NEAR(feedback.back().actual[0], -0.1, kGoalTolerance);
  EXPECT_NEAR(feedback.back().actual[1], 0.6, kGoalTolerance);
  EXPECT_THAT(client().take_statuses(id), ElementsAre(ros2_test::kExecuting, ros2_test::kSucceeded));
  const Arm arm = this->arm();
  EXPECT_NEAR(arm.q[0], 0.6, kGoalTolerance);
  EXPECT_NEAR(arm.q[1], -0.1, kGoalTolerance);
  EXPECT_EQ(client().send(id, goal), false);  // the id is used up
}

TEST_F(Ros2ActionTest, IntermediatePointsArePassedInTime) {
  Uuid id{};
  const Result result = undisturbed([&] {
    (void)client().take_feedback();
    Goal goal;
    goal.points = {{arm().q}, {{0.5, 0.3}}, {{0.6, -0.1}}};
    goal.points[1].time = 0.6;
    goal.points[2].time = 1.4;
    id = ros2_test::random_uuid();
    EXPECT_EQ(client().send(id, goal), true);
    return this->result(id);
  });
  ASSERT_EQ(result.status, ros2_test::kSucceeded) << result.text;
  const std::vector<Feedback> feedback = client().take_feedback();
  const auto away = [](const Feedback& one) { return std::abs(one.time - 0.6); };
  const auto nearest = std::min_element(feedback.begin(), feedback.end(),
                                        [&](const auto& a, const auto& b) { return away(a) < away(b); });
  ASSERT_NE(nearest, feedback.end());
  // At less than 1 rad/s; without the point joint 2 would be at less than 0.2 then.
  const double allowed = 0.01 + away(*nearest);
  ASSERT_LT(allowed, 0.08);
  EXPECT_NEAR(nearest->desired[0], 0.5, allowed);
  EXPECT_NEAR(nearest->desired[1], 0.3, allowed);

  Goal elsewhere = to({0.2, 0.2}, 1.0);
  elsewhere.points.insert(elsewhere.points.begin(), {{0.0, 0.0}});  // says that the arm is there
  const Result refused = outcome(elsewhere);
  EXPECT_EQ(refused.status, ros2_test::kAborted);
  EXPECT_EQ(refused.code, -1);
  EXPECT_FALSE(refused.text.empty());
}

TEST_F(Ros2ActionTest, ACancelledGoalLeavesTheArmAtRest) {
  Uuid id{};
  std::optional<Client::Cancelled> cancelled;
  const Result result = undisturbed([&] {
    id = ros2_test::random_uuid();
    EXPECT_EQ(client().send(id, to({1.2, -0.8}, 2.5)), true);
    wait_for_feedback_at(id, 0.6);
    cancelled = client().cancel(id);
    return this->result(id);
  });
  ASSERT_TRUE(cancelled);
  EXPECT_EQ(cancelled->code, 0);
  EXPECT_THAT(cancelled->goals, ElementsAre(id));
  EXPECT_EQ(result.status, ros2_test::kCanceled) << result.text;
  EXPECT_FALSE(result.text.empty());
  const Arm arm = this->arm();
  EXPECT_EQ(arm.mode, "holding");
  EXPECT_GT(std::hypot(arm.q[0] - 0.3, arm.q[1] - 0.2), 0.05);  // it was on its way
  EXPECT_GT(std::hypot(arm.q[0] - 1.2, arm.q[1] + 0.8), 0.05);
  const Arm later = this->arm();
  for (std::size_t j = 0; j < 2; ++j) EXPECT_NEAR(later.q[j], arm.q[j], 0.001);  // counts of the encoders
  EXPECT_THAT(client().take_statuses(id),
              ElementsAre(ros2_test::kExecuting, ros2_test::kCanceling, ros2_test::kCanceled));

  // From there the arm goes on.
  const Result next = undisturbed([&] { return outcome(to({0.5, 0.0})); });
  EXPECT_EQ(next.status, ros2_test::kSucceeded) << next.text;

  EXPECT_EQ(client().cancel(id)->code, 3);                        // over
  EXPECT_EQ(client().cancel(ros2_test::random_uuid())->code, 2);  // unknown
  EXPECT_EQ(client().cancel(Uuid{})->code, 1);                    // all, of which there are none
}

TEST_F(Ros2ActionTest, AGoalCancelledWhileItIsPlannedNeverMovesTheArm) {
  const Uuid id = ros2_test::random_uuid();
  ASSERT_EQ(client().send(id, to({1.2, -0.8}, 1.5)), true);
  const auto cancelled = client().cancel(Uuid{});  // whatever there is
  ASSERT_TRUE(cancelled);
  EXPECT_THAT(cancelled->goals, ElementsAre(id));
  const Result result = this->result(id);
  EXPECT_EQ(result.status, ros2_test::kCanceled) << result.text;
  EXPECT_THAT(executor().output(), testing::Not(HasSubstr("executing id=")));
}

TEST_F(Ros2ActionTest, WhatIsNotDoneIsRefusedByName) {
  struct Case {
    std::string field;
    int code;
    std::function<void(Goal&)> change;
  };
  const double nan = std::nan("");
  const std::vector<Case> cases = {
      {"trajectory.joint_names: 2 names", -2,
       [](Goal& g) {
         g.names = {"joint1", "elbow"};
       }},
      {"trajectory.joint_names: 1 names", -2, [](Goal& g) { g.names = {"joint1"}; }},
      {"trajectory.joint_names: 3 names", -2,
       [](Goal& g) {
         g.names = {"joint1", "joint2", "joint3"};
       }},
      {"trajectory.joint_names: 2 names", -2,
       [](Goal& g) {
         g.names = {"joint1", "joint1"};
       }},
      {"trajectory.points: is empty", -1, [](Goal& g) { g.points.clear(); }},
      {"goal.q[0]", -1, [](Goal& g) { g.points[0].positions[0] = 9; }},  // outside limits: the service's word
      {"trajectory.points[0].positions: 3 values", -1, [](Goal& g) { g.points[0].positions.push_back(0); }},
      {"trajectory.points[0].positions: 0 values", -1, [](Goal& g) { g.points[0].positions.clear(); }},
      {"trajectory.points[0].positions[1]: nan", -1, [=](Goal& g) { g.points[0].positions[1] = nan; }},
      {"trajectory.points[0].velocities: is not 0", -1,
       [](Goal& g) {
         g.points[0].velocities = {0, 0.1};
       }},
      {"trajectory.points[0].velocities: 1 values", -1, [](Goal& g) { g.points[0].velocities = {0}; }},
      {"trajectory.points[0].accelerations: is not 0", -1,
       [](Goal& g) {
         g.points[0].accelerations = {1, 0};
       }},
      {"trajectory.points[0].effort", -1,
       [](Goal& g) {
         g.points[0].effort = {0, 0};
       }},
      {"trajectory.points[0].time_from_start: is negative", -1, [](Goal& g) { g.points[0].time = -1; }},
      {"trajectory.points[1].time_from_start", -1,
       [](Goal& g) {
         g.points.insert(g.points.begin(), {{{0.3, 0.1}}, {{0.3, 0.0}}});
         g.points[0].time = 0.5;
         g.points[1].time = 0.5;
       }},
      {"trajectory.points[0].time_from_start: 0.5 s", -1,
       [](Goal& g) {
         g.points.insert(g.points.begin(), {{0.3, 0.1}});
         g.points[0].time = 0.5;
         g.points[1].time = 0;
       }},
      {"trajectory.points[0].accelerations: is not empty", -1,
       [](Goal& g) {
         g.points.insert(g.points.begin(), {{0.3, 0.1}, {}, {0, 0}});
         g.points[0].time = 0.5;
       }},
      {"trajectory.points: 33 points", -1,
       [](Goal& g) {
         g.points.clear();
         for (int i = 1; i <= 34; ++i) {
           g.points.push_back({{0.3, 0.2}});
           g.points.back().time = 0.1 * i;
         }
       }},
      {"trajectory.header.stamp", -1, [](Goal& g) { g.stamp = 1700000000; }},
      {"multi_dof_trajectory", -1, [](Goal& g) { g.multi_dof = true; }},
      {"component_path_tolerance", -1, [](Goal& g) { g.component_path_tolerance = true; }},
      {"component_goal_tolerance", -1, [](Goal& g) { g.component_goal_tolerance = true; }},
      {"path_tolerance[0].position: -1", -1,
       [](Goal& g) {
         g.path_tolerance = {{"joint1", -1}};
       }},
      {"path_tolerance[0].name: 'elbow'", -1,
       [](Goal& g) {
         g.path_tolerance = {{"elbow", 0.1}};
       }},
      {"goal_tolerance[1].name: 'joint1' comes twice", -1,
       [](Goal& g) {
         g.goal_tolerance = {{"joint1", 0.1}, {"joint1", 0.1}};
       }},
      {"goal_tolerance[0].velocity", -1,
       [](Goal& g) {
         g.goal_tolerance = {{"joint1", 0.1, 0.1}};
       }},
      {"path_tolerance[0].acceleration", -1,
       [](Goal& g) {
         g.path_tolerance = {{"joint1", 0.1, 0, 0.1}};
       }},
      {"goal_time_tolerance: needs a goal_tolerance", -1, [](Goal& g) { g.goal_time_tolerance = 0.5; }},
      {"goal_time_tolerance: is negative", -1, [](Goal& g) { g.goal_time_tolerance = -0.5; }},
  };
  for (const Case& one : cases) {
    Goal goal = to({0.4, 0.1}, 1.0);
    one.change(goal);
    const Result result = outcome(goal);
    EXPECT_EQ(result.status, ros2_test::kAborted) << one.field;
    EXPECT_EQ(result.code, one.code) << one.field;
    EXPECT_THAT(result.text, HasSubstr(one.field));
  }
  EXPECT_EQ(client().result(ros2_test::random_uuid())->status, ros2_test::kUnknown);
  EXPECT_THAT(executor().output(), testing::Not(HasSubstr("executing id=")));
}

TEST_F(Ros2ActionTest, TolerancesOfAGoalAreKeptOrItIsAborted) {
  Goal goal = to({0.5, 0.0}, 1.0);
  goal.path_tolerance = {{"joint2", 0.02}};
  goal.goal_tolerance = {{"joint1", 0.01}, {"joint2", 0.01}};
  goal.goal_time_tolerance = 0.5;
  const Result kept = undisturbed([&] { return outcome(goal); });
  EXPECT_EQ(kept.status, ros2_test::kSucceeded) << kept.text;

  goal.points[0].positions = {0.3, 0.2};
  goal.goal_time_tolerance = 0;
  goal.goal_tolerance[1].position = 1e-9;  // less than a count of an encoder
  const Result off_goal = undisturbed([&] { return outcome(goal); });
  EXPECT_EQ(off_goal.status, ros2_test::kAborted);
  EXPECT_EQ(off_goal.code, -5) << off_goal.text;
  EXPECT_THAT(off_goal.text, HasSubstr("joint2"));

  goal.points[0].positions = {0.5, 0.0};
  goal.path_tolerance[0].position = 1e-9;
  goal.points[0].time = 1.0;
  const Result off_path = undisturbed([&] { return outcome(goal); });
  EXPECT_EQ(off_path.status, ros2_test::kAborted);
  EXPECT_EQ(off_path.code, -4) << off_path.text;
  EXPECT_THAT(off_path.text, HasSubstr("joint2"));
  const Arm arm = this->arm();  // it was stopped there and then
  EXPECT_EQ(arm.mode, "holding");
  EXPECT_LT(arm.q[0], 0.49);
}

// Both count from 1, and only the clients' numbers before the counts tell their responses apart.
TEST_F(Ros2ActionTest, TwoClientsHaveTheirOwnAnswers) {
  Client other(domain_);
  ASSERT_TRUE(comes_true([&] { return other.server_is_available(); }));
  const Uuid mine = ros2_test::random_uuid(), theirs = ros2_test::random_uuid();
  Goal wrong = to({0.4, 0.1});
  wrong.names = {"left", "right"};
  const std::int64_t my_goal = client().post(mine, to({0.4, 0.1}, 0.8));
  const std::int64_t their_goal = other.post(theirs, wrong);
  ASSERT_EQ(my_goal, their_goal);
  EXPECT_EQ(client().accepted(my_goal), true);
  EXPECT_EQ(other.accepted(their_goal), true);
  const std::int64_t my_result = client().ask_result(mine), their_result = other.ask_result(theirs);
  ASSERT_EQ(my_result, their_result);
  const auto their_outcome = other.await_result(their_result);
  ASSERT_TRUE(their_outcome);
  EXPECT_EQ(their_outcome->code, -2) << their_outcome->text;

  // A goal while another is executed.
  const Uuid second = ros2_test::random_uuid();
  EXPECT_EQ(other.send(second, to({0.0, 0.0})), true);
  const auto busy = other.result(second);
  ASSERT_TRUE(busy);
  EXPECT_EQ(busy->status, ros2_test::kAborted);
  EXPECT_THAT(busy->text, HasSubstr("is being executed"));

  const auto my_outcome = client().await_result(my_result, 60);
  ASSERT_TRUE(my_outcome);
  EXPECT_NE(my_outcome->code, -2);
  EXPECT_GT(client().send_goal.strangers + other.send_goal.strangers + client().get_result.strangers +
                other.get_result.strangers,
            0);  // what was for the other one did arrive, as it does in ROS 2
}

// A thread of the bridge that waits for one client would keep the others waiting.
TEST_F(Ros2ActionTest, AClientThatDoesNotReadCostsTheOthersNothing) {
  using Request = control_msgs_action_dds__FollowJointTrajectory_GetResult_Request_;
  const dds_entity_t participant = dds_create_participant(domain_, nullptr, nullptr);
  {
    ros2_test::Service<Request, control_msgs_action_dds__FollowJointTrajectory_GetResult_Response_> deaf(
        participant, control_msgs_action_dds__FollowJointTrajectory_GetResult_Request__desc,
        control_msgs_action_dds__FollowJointTrajectory_GetResult_Response__desc,
        "/arm/follow_joint_trajectory/_action/get_result", true);
    dds_publication_matched_status_t matched{};
    ASSERT_TRUE(comes_true([&] {
      ros2_test::checked(dds_get_publication_matched_status(deaf.writer(), &matched), "matched");
      return matched.current_count > 0;
    }));
    Request request{};
    for (int i = 0; i < 50; ++i) (void)deaf.send(request);
    // One after the other they would take 0.1 s each; an answer takes some ms.
    EXPECT_TRUE(client().result(ros2_test::random_uuid(), 1));
  }
  dds_delete(participant);
}

// Requests of the right name, and of whatever bytes: lengths of sequences and strings that are not there, above all.
class HostileWriter {
 public:
  using Words = std::array<std::uint32_t, sizeof(HostileBytes) / 4>;

  HostileWriter(dds_entity_t participant, const std::string& service, const char* type_name)
      : type_(HostileBytes_desc) {
    type_.m_typename = type_name;
    const dds_entity_t topic =
        ros2_test::topic(participant, type_, "rq/arm/follow_joint_trajectory/_action/" + service + "Request");
    dds_qos_t* qos = ros2_test::default_qos();
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);  // all of them arrive
    writer_ = ros2_test::checked(dds_create_writer(participant, topic, qos, nullptr), "writer");
    dds_delete_qos(qos);
  }

  bool matched() const {
    dds_publication_matched_status_t matched{};
    ros2_test::checked(dds_get_publication_matched_status(writer_, &matched), "matched");
    return matched.current_count > 0;
  }
  void write(const Words& words) const {
    HostileBytes bytes{};
    std::memcpy(bytes.bytes, words.data(), sizeof bytes.bytes);
    ros2_test::checked(dds_write(writer_, &bytes), "write");
  }
  void flush() const { ros2_test::checked(dds_wait_for_acks(writer_, DDS_SECS(10)), "acks"); }

 private:
  dds_topic_descriptor_t type_;
  dds_entity_t writer_ = 0;
};

// A goal without joints, word by word: what is hostile is made from it, so that much of it is read before it is
// dropped.
HostileWriter::Words goal_without_joints(const Uuid& id) {
  HostileWriter::Words words{7, 0, 1, 0};  // guid, seq
  std::memcpy(&words[4], id.data(), id.size());
  words[10] = 1;  // behind the stamp: frame_id has one character, its zero. Then no names, no points
  words[16] = 1;  // the same of multi_dof_trajectory; then no tolerances
  return words;
}

TEST_F(Ros2ActionTest, HostileBytesAreDropped) {
  const dds_entity_t participant = dds_create_participant(domain_, nullptr, nullptr);
  const std::vector<HostileWriter> writers{
      {participant, "send_goal", control_msgs_action_dds__FollowJointTrajectory_SendGoal_Request__desc.m_typename},
      {participant, "cancel_goal", action_msgs_srv_dds__CancelGoal_Request__desc.m_typename},
      {participant, "get_result", control_msgs_action_dds__FollowJointTrajectory_GetResult_Request__desc.m_typename}};
  for (const HostileWriter& writer : writers) ASSERT_TRUE(comes_true([&] { return writer.matched(); }));

  // The bytes do arrive, and are read as a request.
  const Uuid id = ros2_test::random_uuid();
  writers[0].write(goal_without_joints(id));
  writers[0].flush();
  const auto read = client().result(id);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->code, -2) << read->text;

  std::mt19937 random(1);
  const std::array<std::uint32_t, 12> numbers{0,  0,           1,           1,           2,           3,
                                              16, 0xffffffffU, 0x7fffffffU, 0x10000000U, 0x00ffffffU, 0x00000100U};
  const auto number = [&] {
    return random() % 4 == 0 ? static_cast<std::uint32_t>(random()) : numbers[random() % numbers.size()];
  };
  for (const HostileWriter& writer : writers) {
    for (int i = 0; i < 3000; ++i) {
      HostileWriter::Words words = goal_without_joints(ros2_test::random_uuid());
      if (i % 3 == 0) std::generate(words.begin(), words.end(), number);
      for (int n = 0; n < i % 4; ++n) words[8 + random() % 24] = number();  // what follows the goal's id
      writer.write(words);
      if (i % 200 == 0) writer.flush();
    }
    writer.flush();
  }
  dds_delete(participant);
  Goal wrong = to({0.4, 0.1});
  wrong.names = {"left", "right"};
  EXPECT_EQ(outcome(wrong).code, -2);
  EXPECT_THAT(executor().output(), testing::Not(HasSubstr("executing id=")));
  bridge().send(SIGTERM);
  EXPECT_EQ(bridge().wait(), 0) << bridge().output();
}

// Whoever ends the bridge wants no motion that nobody listens to.
TEST_F(Ros2ActionTest, AnEndedBridgeLeavesTheArmAtRest) {
  const Uuid id = ros2_test::random_uuid();
  ASSERT_EQ(client().send(id, to({1.2, -0.8}, 2.5)), true);
  wait_for_feedback_at(id, 0.6);
  bridge().send(SIGTERM);
  EXPECT_EQ(bridge().wait(), 0) << bridge().output();
  const Arm arm = this->arm();
  EXPECT_EQ(arm.mode, "holding");
  EXPECT_GT(std::hypot(arm.q[0] - 1.2, arm.q[1] + 0.8), 0.05);
}

// What is otherwise refused by name is left to the planner where the bridge was told so; and the configuration's names.
TEST_F(Ros2ActionTest, OptionsAndConfigurationAreKept) {
  end_bridge();
  write("service.yaml", "robot: " FJR_SOURCE_DIR "/config/robot.yaml\nros2: {joint_names: [shoulder, elbow]}\n");
  start_bridge({"--config", path("service.yaml"), "--leave-accelerations", "--kilted"});
  ros2_test::LaterFeedback later(domain_);
  Goal goal = to({0.5, 0.1}, 1.0);
  goal.points.insert(goal.points.begin(), {{0.4, 0.15}, {}, {0.1, 0.1}});
  goal.points[0].time = 0.5;
  EXPECT_EQ(outcome(goal).code, -2);
  goal.names = {"shoulder", "elbow"};
  const Result result = undisturbed([&] { return outcome(goal); });
  EXPECT_EQ(result.status, ros2_test::kSucceeded) << result.text;
  EXPECT_GT(later.take(), 10);
}

TEST_F(Ros2ActionTest, ANameThatRos2DoesNotTakeIsRefused) {
  const auto refused = fjr({"ros2-action", "--action", "arm/follow"}, "refused.log");
  EXPECT_EQ(refused->wait(), 2);
  EXPECT_THAT(refused->output(), HasSubstr("--action: 'arm/follow' is no full name of ROS 2"));
}

}  // namespace
}  // namespace fjr
