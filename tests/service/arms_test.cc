// One service for two arms, `robots` in service.yaml: real processes over the loopback interface. Everything that has
// to do with one arm has nothing to do with the other, but for the time that their requests take.
#include <map>
#include <nlohmann/json.hpp>

#include "tests/service/service_fixture.h"

namespace fjr {
namespace {

const std::vector<std::string> kArms = {"left", "right"};
const std::vector<std::string> kRehearsal = {"--rehearse", "0.2"};  // s that a request takes, of waiting
constexpr double kTakes = 0.2;

class ArmsTest : public ServiceTest {
 protected:
  using Instance = std::unique_ptr<Process>;

  void SetUp() override {
    ServiceTest::SetUp();
    const std::string robot = contents(FJR_SOURCE_DIR "/config/robot.yaml");
    write("left.yaml", robot);
    write("right.yaml", robot + "\npayload: 0.1\n");
  }

  Instance start(const std::string& name, const std::vector<std::string>& more = {}, const std::string& keys = "") {
    write(name + ".yaml",
          "{instance: " + name + keys + ", robots: [{id: left, robot: left.yaml}, {id: right, robot: right.yaml}]}\n");
    return run(name, more);
  }
  // One for the left arm alone.
  Instance start_left(const std::string& name) {
    write(name + ".yaml", "{instance: " + name + ", robot_id: left, robot: left.yaml}\n");
    return run(name, {});
  }
  Instance run(const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"serve", "--config", path(name + ".yaml"), "--domain", domain()};
    words.insert(words.end(), more.begin(), more.end());
    return start_fjr(words, name + ".log");
  }
  // Without waiting for the clock: whether two arms keep it on a busy machine is nothing of the service's.
  std::map<std::string, Instance> start_executors() {
    std::map<std::string, Instance> executors;
    for (const std::string& arm : kArms) {
      executors[arm] = start_fjr({"executor", "--robot-id", arm, "--robot", path(arm + ".yaml"), "--start", "0.3,0.2",
                                  "--state", path(arm + ".state"), "--domain", domain(), "--fast"},
                                 arm + ".executor");
    }
    for (const auto& [arm, executor] : executors) {
      EXPECT_TRUE(says(*executor, "executing for"));
    }
    settle();
    return executors;
  }

  std::uint64_t epoch(const std::string& instance) { return heard_[instance].epoch; }
  void wait_for_owner(const std::string& name) {
    wait_until([&] { return epoch(name + "/left") > 0 && epoch(name + "/right") > 0; });
    settle();
  }
  Order for_arm(const std::string& arm, Action action = Action::kPlan) {
    Order one = order(kFast);
    one.robot_id = arm;
    one.action = action;
    return one;
  }
  Order sent_for(const std::string& arm, Action action = Action::kPlan) {
    Order one = for_arm(arm, action);
    send(one);
    return one;
  }

  // Many wait for one arm, and then, one after the other, some come for the other: each of those is behind what is
  // being solved, and behind nothing else.
  void expect_fair() {
    constexpr std::size_t kFlood = 12, kFew = 3;
    std::vector<RequestId> flood;
    for (std::size_t i = 0; i < kFlood; ++i) flood.push_back(sent_for("left").id);
    for (const RequestId& id : flood) expect_accepted(id);
    std::size_t before = 0;  // finals of the flood before those of the others
    const auto began = Clock::now();
    for (std::size_t i = 0; i < kFew; ++i) {
      const RequestId id = sent_for("right").id;
      for (auto reply = next_final(); reply && reply->id != id; reply = next_final()) ++before;
    }
    const double took = seconds_since(began);
    // One that was being solved when it came, and one that was begun while it was under way.
    EXPECT_LE(before, 2 * kFew);
    EXPECT_GE(before, 1u);  // nor is the flood kept waiting
    for (std::size_t i = before; i < kFlood; ++i) EXPECT_TRUE(next_final());
    // With one slot for both, nothing was solved beside anything else. That of the flood was begun before.
    EXPECT_GT(took, static_cast<double>(before + kFew - 1) * kTakes);
    EXPECT_FALSE(next_final(0.3));
  }
};

TEST_F(ArmsTest, EachHasItsRobotItsOwnerAndItsExecutor) {
  const Instance service = start("cell");
  connect();
  wait_for_owner("cell");
  auto executors = start_executors();
  std::map<std::string, Order> orders;
  for (const std::string& arm : kArms) orders[arm] = sent_for(arm, Action::kPlanAndExecute);
  std::map<std::string, Reply> replies;
  for (const std::string& arm : kArms) {
    replies[arm] = final_reply(orders[arm].id);
    EXPECT_EQ(replies[arm].state, ReplyState::kSolved) << replies[arm].why.sentence;
    EXPECT_EQ(replies[arm].robot_id, arm);
  }
  EXPECT_NE(replies["left"].robot_hash, replies["right"].robot_hash);
  EXPECT_NE(replies["left"].rows.back().time, replies["right"].rows.back().time);
  for (const std::string& arm : kArms) {
    EXPECT_TRUE(says(*executors[arm], "finished id=" + text(orders[arm].id) + " code=0")) << executors[arm]->output();
    EXPECT_EQ(count(executors[arm]->output(), "executing id="), 1u);
    EXPECT_EQ(count(executors[arm]->output(), "refused"), 0u) << executors[arm]->output();
  }
  const Order nobodys = sent_for("");
  const Reply refused = final_reply(nobodys.id);
  EXPECT_EQ(refused.state, ReplyState::kRejected);
  EXPECT_THAT(refused.why.sentence, HasSubstr("several robots are served (left, right): name one"));
  service->send(SIGTERM);
  EXPECT_EQ(service->wait(), 0);
}

TEST_F(ArmsTest, AFloodForOneArmDelaysTheOtherByASolve) {
  const Instance service = start("cell", kRehearsal);
  connect();
  wait_for_owner("cell");
  expect_fair();
}

TEST_F(ArmsTest, AFloodForOneArmDelaysTheOtherByASolveOnOtherMachinesToo) {
  const Instance service = start("cell", {"--workers", "0"});
  const Instance worker = start("worker", {"--worker-only", "--rehearse", "0.2"});
  connect();
  wait_until([&] { return heard_["cell/left"].workers == 1 && heard_["cell/right"].workers == 1; });
  settle();
  expect_fair();
  worker->send(SIGTERM);
  EXPECT_EQ(worker->wait(), 0);
}

TEST_F(ArmsTest, TheEpochsAreApart) {
  const Instance other = start_left("other");
  connect();
  wait_until([&] { return epoch("other") > 0; });
  const Instance service = start("cell");
  wait_until([&] { return epoch("cell/right") > 0 && heard_.contains("cell/left"); });
  settle();
  EXPECT_EQ(epoch("cell/left"), 0u);
  const std::uint64_t of_right = epoch("cell/right");
  other->send(SIGKILL);
  wait_until([&] { return epoch("cell/left") > epoch("other"); });
  EXPECT_EQ(epoch("cell/right"), of_right);
  const auto executors = start_executors();
  for (const std::string& arm : kArms) {
    EXPECT_EQ(final_reply(sent_for(arm, Action::kPlanAndExecute).id).state, ReplyState::kSolved);
    EXPECT_TRUE(says(*executors.at(arm), " code=0")) << executors.at(arm)->output();
  }
  Process status = fjr({"status", "--json", "--domain", domain()}, "status");
  EXPECT_EQ(status.wait(), 0);
  std::map<std::string, std::uint64_t> ran;
  const nlohmann::json told = nlohmann::json::parse(status.output());
  for (const auto& executor : told["executors"]) {
    ran[executor["robot_id"]] = executor["epoch"];
  }
  EXPECT_EQ(ran, (std::map<std::string, std::uint64_t>{{"left", epoch("cell/left")}, {"right", of_right}}));
}

TEST_F(ArmsTest, AStandbyTakesBothOverWithWhatWasInHand) {
  const Instance first = start("first");
  connect();
  wait_for_owner("first");
  const Instance second = start("second");
  wait_until([&] { return heard_.contains("second/left") && heard_.contains("second/right"); });
  const auto executors = start_executors();
  std::map<std::string, Order> orders;
  for (const std::string& arm : kArms) orders[arm] = sent_for(arm, Action::kPlanAndExecute);
  for (const std::string& arm : kArms) expect_accepted(orders[arm].id);
  first->send(SIGKILL);
  for (const std::string& arm : kArms) {
    EXPECT_EQ(final_reply(orders[arm].id).state, ReplyState::kSolved);
    EXPECT_TRUE(says(*executors.at(arm), "finished id=" + text(orders[arm].id) + " code=0"));
    EXPECT_EQ(count(executors.at(arm)->output(), "executing id="), 1u) << executors.at(arm)->output();
  }
  for (const std::string& arm : kArms) wait_until([&] { return epoch("second/" + arm) > epoch("first/" + arm); });
}

TEST_F(ArmsTest, WatchingTellsOfBothAndOfWhoIsSilent) {
  const Instance service = start("cell");
  connect();
  const Instance watching =
      start_fjr({"status", "--watch", "--json", "--wait", "0.5", "--domain", domain()}, "watching");
  const auto last_look = [&] {
    const std::string all = watching->output();
    const std::size_t end = all.rfind('\n');
    if (end == std::string::npos) return nlohmann::json();
    const std::size_t before = end == 0 ? std::string::npos : all.rfind('\n', end - 1);
    return nlohmann::json::parse(all.substr(before == std::string::npos ? 0 : before + 1, end - before));
  };
  wait_until([&] { return !last_look().is_null() && last_look()["services"].size() == 2; });
  EXPECT_TRUE(last_look()["silent"].empty());
  service->send(SIGKILL);
  wait_until([&] { return last_look()["silent"].size() == 2; });
  EXPECT_EQ(last_look()["silent"][0]["name"], "cell/left");
  EXPECT_TRUE(last_look()["services"].empty());
  watching->send(SIGINT);
  EXPECT_EQ(watching->wait(), 0);
}

// Its other arm would be served by nobody, and nobody would be told.
TEST_F(ArmsTest, OneWithAnotherFileForOneOfThemEndsAndSaysSo) {
  const Instance first = start("first");
  connect();
  wait_for_owner("first");
  write("second.yaml", "{instance: second, robots: [{id: left, robot: right.yaml}, {id: other}]}\n");
  const Instance second = run("second", {});
  EXPECT_EQ(second->wait(), 2);
  EXPECT_THAT(second->output(), HasSubstr("robot_id left is served by instance first/left with another robot"));
  EXPECT_EQ(final_reply(sent_for("left").id).state, ReplyState::kSolved);
}

}  // namespace
}  // namespace fjr
