// What clients see of an arm while it moves: the executor keeps to the clock, so nothing should run beside these.
#include "tests/service/service_fixture.h"

namespace fjr {
namespace {

class MovingArmTest : public ServiceTest {
 protected:
  void serve_and_execute() {
    serve();
    executor_ = start_executor("0.3,0.2", {});
    wait_for_executor();
    settle();
  }
  Order motion(const std::string& yaml) {
    Order one = order(yaml);
    one.action = Action::kPlanAndExecute;
    return one;
  }
  Reply answer_to(const Order& order) {
    send(order);
    return final_reply(order.id);
  }
  void expect_said(const std::string& what) { EXPECT_TRUE(says(*executor_, what)) << executor_->output(); }

 private:
  std::unique_ptr<Process> executor_;
};

TEST_F(MovingArmTest, IsBroughtToRestByWhoeverIsInterrupted) {
  serve_and_execute();
  write("long.yaml", "goal: {q: [0.6, -0.2]}\nduration: 2\nsearch: quick\n");
  Process request = fjr({"request", path("long.yaml"), "--domain", domain(), "--execute"}, "request.log");
  expect_said("executing id=");
  request.send(SIGINT);
  EXPECT_EQ(request.wait(), 1);
  EXPECT_THAT(request.output(), HasSubstr("not executed to its end: "));
  expect_said("hold commanded");
}

TEST_F(MovingArmTest, IsWhereRequestsWithoutAStartBeginOnceItRests) {
  serve_and_execute();
  const std::string back = "goal: {q: [0.3, 0.2]}\nobjective: fastest\n";
  const Order first = motion("goal: {q: [0.42, 0.08]}\nobjective: fastest\n");
  const Reply there = answer_to(first);
  ASSERT_EQ(there.state, ReplyState::kSolved) << there.why.sentence;
  const Reply refused = answer_to(order(back));
  EXPECT_EQ(refused.state, ReplyState::kRejected);
  EXPECT_EQ(refused.why.field, "start");
  EXPECT_THAT(refused.why.sentence, HasSubstr("left out, but the arm is"));
  expect_said("finished id=" + text(first.id) + " code=0");
  settle();
  const Order second = motion(back);
  const Reply reply = answer_to(second);
  ASSERT_EQ(reply.state, ReplyState::kSolved) << reply.why.sentence;
  // The goal that is held, to the last bit: not what the encoders count.
  EXPECT_EQ(reply.rows.front().state.q, (Joints<double>{0.42, 0.08}));
  expect_said("finished id=" + text(second.id) + " code=0");
}

}  // namespace
}  // namespace fjr
