// Owner, standby and workers are upgraded one after the other while requests keep coming, and back: instances of two
// versions serve side by side, and no request is lost or done twice.
#include <map>

#include "tests/service/service_fixture.h"

namespace fjr {
namespace {

const std::string kNext = "1000.0.0";  // next_version.cc

struct Version {
  std::string program, name;
};

class UpgradeTest : public ServiceTest, public testing::WithParamInterface<bool> {
 protected:
  using Instance = std::unique_ptr<Process>;

  Instance start(const std::string& name, const Version& version, std::vector<std::string> more = {}) {
    write(name + ".yaml", "{instance: " + name + ", warm_plans: 0, remember: " + name + ".replies}\n");
    std::vector<std::string> words = {version.program, "serve", "--config", path(name + ".yaml"), "--domain", domain()};
    words.insert(words.end(), more.begin(), more.end());
    return std::make_unique<Process>(words, path(name + ".log"));
  }
  // Ends it, as an upgrade does, and has the other version run by its name.
  void upgrade(Instance& instance, const std::string& name) {
    instance->send(SIGTERM);
    EXPECT_EQ(instance->wait(), 0);
    heard_.erase(name);
    instance = start(name, to_);
    wait_until([&] { return heard_[name].version == to_.name; });
    EXPECT_TRUE(says(*instance, "as standby"));
  }

  // Meanwhile requests keep coming.
  void listen() override {
    if (asking_ && seconds_since(asked_last_) > 0.25) {
      orders_.push_back(order(kFast));
      send(orders_.back());
      asked_last_ = Clock::now();
    }
    ServiceTest::listen();
  }

  const Version this_{FJR_EXECUTABLE, FJR_VERSION}, next_{FJR_NEXT, kNext};
  const Version from_ = GetParam() ? this_ : next_, to_ = GetParam() ? next_ : this_;
  bool asking_ = false;
  std::vector<Order> orders_;

 private:
  Clock::time_point asked_last_{};
};

INSTANTIATE_TEST_SUITE_P(, UpgradeTest, testing::Bool(),
                         [](const auto& one) { return std::string(one.param ? "ToTheNext" : "Back"); });

TEST_P(UpgradeTest, OneAfterTheOtherLosesNothing) {
  Instance a = start("a", from_);
  connect();
  wait_until([&] { return heard_["a"].epoch > 0; });
  Instance b = start("b", from_);
  EXPECT_TRUE(says(*b, "as standby"));
  const Instance executor = start_executor();
  wait_for_executor();
  const Order first = order(kFast);
  send(first);
  const Reply answer = final_reply(first.id);
  EXPECT_EQ(answer.version, from_.name);
  settle();  // its standby has heard it, too
  asking_ = true;
  listen_for(0.5);
  upgrade(b, "b");
  listen_for(0.5);
  Order move = order(kFast);
  move.action = Action::kPlanAndExecute;
  send(move);
  expect_accepted(move.id);
  upgrade(a, "a");
  wait_until([&] { return heard_["b"].epoch > 0; });
  listen_for(0.5);
  asking_ = false;
  const Reply moved = final_reply(move.id);
  EXPECT_EQ(moved.state, ReplyState::kSolved) << moved.why.sentence;
  std::map<std::string, int> answered_by;
  for (const Order& one : orders_) {
    const Reply reply = final_reply(one.id);
    EXPECT_EQ(reply.state, ReplyState::kSolved) << reply.why.sentence;
    ++answered_by[reply.version];
  }
  EXPECT_EQ(answered_by.size(), 2u);  // both versions had their share
  EXPECT_FALSE(next_final(0.3));      // each once
  EXPECT_TRUE(result_of(move.id));
  const std::string log = executor->output();
  EXPECT_NE(log.find("executing id=" + text(move.id)), std::string::npos) << log;
  EXPECT_EQ(log.find("executing id="), log.rfind("executing id=")) << log;
  // What was answered before there was any of the later version, that answers the same.
  send(first);
  const Reply again = final_reply(first.id);
  EXPECT_TRUE(again.plan_json == answer.plan_json);
  EXPECT_EQ(again.rows.size(), answer.rows.size());
}

// An owner that has not been upgraded yet is worked for by those of its version, and the upgraded one by the others.
TEST_P(UpgradeTest, WorkersAreGivenWorkByTheOwnerOfTheirVersion) {
  Instance owner = start("owner", from_, {"--workers", "0"});
  const Instance earlier = start("earlier", from_, {"--worker-only"}), later = start("later", to_, {"--worker-only"});
  connect();
  wait_until([&] { return heard_["owner"].workers == 1; });
  EXPECT_TRUE(says(*later, "no leases for this worker"));
  EXPECT_THAT(later->output(), HasSubstr("instance owner is fjr " + from_.name + ", this worker is fjr " + to_.name));
  const Order before = order(kFast);
  send(before);
  EXPECT_EQ(final_reply(before.id).state, ReplyState::kSolved);
  EXPECT_THAT(earlier->output(), HasSubstr("leased by=owner"));
  owner->send(SIGTERM);
  EXPECT_EQ(owner->wait(), 0);
  heard_.clear();
  owner = start("owner", to_, {"--workers", "0"});
  wait_until([&] { return heard_["owner"].workers == 1; });
  const Order after = order(kFast);
  send(after);
  EXPECT_EQ(final_reply(after.id).state, ReplyState::kSolved);
  EXPECT_THAT(later->output(), HasSubstr("leased by=owner"));
}

}  // namespace
}  // namespace fjr
