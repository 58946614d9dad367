// The service and the world it runs in: systemd, services of other versions, other robots.
#include <fjr_msgs.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstdlib>

#include "common/descriptor.h"
#include "planner/dds/participant.h"
#include "planner/dds/reader.h"
#include "tests/service/service_fixture.h"
#include "tests/support/named_socket.h"

namespace fjr {
namespace {

// What systemd listens on.
class NotifySocket {
 public:
  NotifySocket() : socket_(named_socket(name_)) {
    EXPECT_GE(socket_.number(), 0);
    const timeval patience{10, 0};
    ::setsockopt(socket_.number(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }

  std::string address() const { return "@" + name_; }  // as systemd writes it

  std::string next() const {
    char word[256];
    const ssize_t length = ::recv(socket_.number(), word, sizeof word, 0);
    return length < 0 ? "" : std::string(word, static_cast<std::size_t>(length));
  }
  // True: it comes within ten words.
  bool hear(const std::string& wanted) const {
    for (int i = 0; i < 10; ++i) {
      if (next() == wanted) return true;
    }
    return false;
  }

 private:
  const std::string name_ = "fjr_test_notify_" + std::to_string(::getpid());
  Descriptor socket_;
};

class SupervisionTest : public ServiceTest {};

TEST_F(SupervisionTest, SystemdHearsOfStartWorkAndEnd) {
  const NotifySocket systemd;
  ::setenv("NOTIFY_SOCKET", systemd.address().c_str(), 1);
  serve();
  ::unsetenv("NOTIFY_SOCKET");
  EXPECT_TRUE(systemd.hear("READY=1"));
  EXPECT_TRUE(systemd.hear("WATCHDOG=1"));
  EXPECT_TRUE(systemd.hear("WATCHDOG=1"));
  service().send(SIGTERM);
  EXPECT_TRUE(systemd.hear("STOPPING=1"));
  EXPECT_EQ(service().wait(), 0);
}

// A reader of requests as another version of the service might have it.
class OtherReader {
 public:
  OtherReader(unsigned domain, const dds_topic_descriptor_t& type, const dds::Qos& qos)
      : participant_(domain),
        topic_(dds_create_topic(participant_.handle(), &type, "fjr/plan_request", nullptr, nullptr), "topic"),
        reader_(dds_create_reader(participant_.handle(), topic_.handle(), qos.get(), nullptr), "reader") {}

 private:
  dds::Participant participant_;
  dds::Entity topic_, reader_;
};

TEST_F(SupervisionTest, ClientSaysWhatIsIncompatible) {
  write("fast.yaml", kFast);
  const auto said = [&] {
    Process request =
        fjr({"request", path("fast.yaml"), "--domain", domain(), "--find", "0.5", "--silence", "1"}, "request");
    EXPECT_EQ(request.wait(), 1);
    return request.output();
  };
  dds::Qos reliable, demanding;
  reliable.reliable(DDS_MSECS(100));
  demanding.reliable(DDS_MSECS(100)).transient_local();
  {
    const OtherReader reader(domain_, fjr_msg_PlanCancel_desc, reliable);
    EXPECT_THAT(said(), HasSubstr("its type is fjr::msg::PlanCancel and not fjr::msg::PlanRequest"));
  }
  {
    dds_topic_descriptor_t changed = fjr_msg_PlanCancel_desc;
    changed.m_typename = "fjr::msg::PlanRequest";
    const OtherReader reader(domain_, changed, reliable);
    EXPECT_THAT(said(), HasSubstr("its version has other types"));  // DDS compares names only
  }
  {
    const OtherReader reader(domain_, fjr_msg_PlanRequest_desc, demanding);
    EXPECT_THAT(said(), HasSubstr("its quality of service does not go with ours (durability)"));
  }
}

class TwoRobotsTest : public SupervisionTest {
 protected:
  void serve_both() {
    serve("{instance: one, robot_id: left, workers: 1}\n");
    write("other.yaml", "{instance: two, robot_id: right, workers: 1}\n");
    other_ = start_fjr({"serve", "--config", path("other.yaml"), "--domain", domain()}, "other.log");
    wait_until([&] { return heard_["one"].epoch > 0 && heard_["two"].epoch > 0; });
    settle();
  }

  Order order_for(const std::string& robot, const std::string& yaml) {
    Order of_robot = order(yaml);
    of_robot.robot_id = robot;
    return of_robot;
  }

  std::unique_ptr<Process> other_;
};

// Its owner ends what waits, and says so once; the other one, which does not know of it, says nothing. Whether the
// client names the robot or, as earlier versions, cannot.
TEST_F(TwoRobotsTest, ACancelledRequestThatWaitsIsAnsweredByItsOwnerAlone) {
  serve_both();
  for (const std::string named : {"", "right"}) {
    const Order solved = order_for("right", kSlow), waits = order_for("right", kSlow);
    send(solved);
    expect_accepted(solved.id);
    send(waits);
    expect_accepted(waits.id);
    cancel(waits.id, named);
    const Reply reply = final_reply(waits.id);
    EXPECT_EQ(reply.state, ReplyState::kCancelled);
    EXPECT_EQ(reply.robot_id, "right");
    EXPECT_EQ(reply.why.sentence, "cancelled while it waited");
    cancel(solved.id, named);
    EXPECT_EQ(final_reply(solved.id).robot_id, "right");
    settle();
    EXPECT_FALSE(next_final(0.5)) << named;
  }
}

// One that waits for the executor to be met, as requests do in the first 2 s of a service that leave their start out.
TEST_F(TwoRobotsTest, ACancelledRequestThatWaitsForTheExecutorIsAnsweredByItsOwnerAlone) {
  serve_both();
  other_->send(SIGKILL);
  (void)other_->wait();
  other_ = start_fjr({"serve", "--config", path("other.yaml"), "--domain", domain()}, "other.log");
  EXPECT_TRUE(says(*other_, "owner robot_id=right"));
  settle();
  for (const std::string named : {"", "right"}) {
    const Order waits = order_for("right", "goal: {q: [0.1, 0.1]}\n");
    send(waits);
    std::this_thread::sleep_for(milliseconds(50));
    cancel(waits.id, named);
    const Reply reply = final_reply(waits.id);
    EXPECT_EQ(reply.state, ReplyState::kCancelled) << reply.why.sentence;
    EXPECT_EQ(reply.robot_id, "right");
  }
  EXPECT_FALSE(next_final(2.5));  // not again when the executor is taken for absent
}

TEST_F(TwoRobotsTest, EachRobotHasItsOwner) {
  serve_both();
  const auto answer = [&](const std::string& robot) {
    Order plan = order(kFast);
    plan.robot_id = robot;
    send(plan);
    return final_reply(plan.id);
  };
  EXPECT_EQ(answer("left").robot_id, "left");
  EXPECT_EQ(answer("right").robot_id, "right");
  const Reply unnamed = answer("");
  EXPECT_EQ(unnamed.why.field, "robot_id");
  EXPECT_EQ(unnamed.why.sentence, "several robots are served (left, right): name one");
  EXPECT_EQ(answer("middle").why.sentence, "middle is not served; there is left, right");
  // Of a request that nobody knows, too: its owner may be told from its robot.
  for (const std::string robot : {"left", "right"}) {
    const Order never_sent = order(kFast);
    cancel(never_sent.id, robot);
    const Reply cancelled = final_reply(never_sent.id);
    EXPECT_EQ(cancelled.state, ReplyState::kCancelled);
    EXPECT_EQ(cancelled.robot_id, robot);
  }
}

}  // namespace
}  // namespace fjr
