// Replies that outlive the service: it is killed, and the same ids are answered with the same bytes.
#include <sys/resource.h>

#include <cstdlib>

#include "common/sha256.h"
#include "planner/service/reply_cache.h"
#include "planner/service/reply_record.h"
#include "planner/service/reply_store.h"
#include "tests/service/service_fixture.h"

namespace fjr {
namespace {

const std::string kRefused = "start: {q: [0, 0]}\ngoal: {q: [1.2, 3.4]}\n";  // at once
const std::string kNotRemembered = "replies are not remembered over a restart while this lasts";

// All that a client is told, short enough to be shown.
std::string told(const Reply& reply) { return sha256_hex(to_record(reply)); }

// Its client lives on while the service is killed and started again, and asks again where it hears nothing.
class RememberTest : public ServiceTest {
 protected:
  void TearDown() override {
    if (HasFailure() && serving_) std::fputs(serving_->output().c_str(), stderr);
    serving_.reset();
    ServiceTest::TearDown();
  }

  void start(const std::vector<std::string>& before = {}) {
    write("service.yaml", "{workers: 1, remember: memory}\n");
    std::vector<std::string> words = before;
    words.insert(words.end(), {FJR_EXECUTABLE, "serve", "--domain", domain(), "--config", path("service.yaml")});
    serving_ = std::make_unique<Process>(words, path("serve.log"));
    EXPECT_TRUE(says("owner robot_id=arm"));
  }
  void kill_service() {
    serving_->send(SIGKILL);
    EXPECT_EQ(serving_->wait(), -1);
  }
  pid_t pid() const { return serving_->pid(); }
  std::string log() const { return serving_->output(); }
  bool says(const std::string& text, double limit = 5) {
    const auto began = Clock::now();
    while (count(log(), text) == 0 && seconds_since(began) < limit) std::this_thread::sleep_for(milliseconds(10));
    return count(log(), text) > 0;
  }

  Reply ask(const Order& order) {
    return asked(order.id, [&] { send(order); });
  }
  Reply ask_to_cancel(const RequestId& id) {
    return asked(id, [&] { cancel(id); });
  }
  template <class Ask>
  Reply asked(const RequestId& id, Ask&& again) {
    for (int i = 0; i < 20; ++i) {
      again();
      for (const auto began = Clock::now(); seconds_since(began) < 0.5;) {
        const auto reply = next_final(0.1);
        if (reply && reply->id == id) return *reply;
      }
    }
    ADD_FAILURE() << "no reply to " << text(id);
    return {};
  }
  fs::path file() const { return path("memory/replies.sqlite"); }

  void expect_nothing_solved(std::uint64_t repeated) {
    const ServiceStatus status =
        status_when([&](const ServiceStatus& s) { return s.duplicates >= repeated && s.received == 0; });
    EXPECT_EQ(status.solved, 0u);
  }

 private:
  std::unique_ptr<Process> serving_;
};

TEST_F(RememberTest, TheSameIdIsAnsweredWithTheSameBytesAfterAKill) {
  const std::string synchronised = path("synchronised").string();
  ::setenv("LD_PRELOAD", FJR_RECORDED_FILES, 1);
  ::setenv("FJR_RECORDED_FILES", synchronised.c_str(), 1);
  start();
  ::unsetenv("LD_PRELOAD");
  ::unsetenv("FJR_RECORDED_FILES");
  connect();
  const auto synchronisations = [&] { return count(contents(synchronised), "replies.sqlite-wal\n"); };
  const std::size_t before = synchronisations();
  const Order one = order(kFast), bad = order(kRefused), never_sent = order(kFast);
  const Reply refused = ask(bad);
  EXPECT_EQ(refused.state, ReplyState::kRejected);
  EXPECT_GT(synchronisations(), before);  // before its client has heard it
  const Reply solved = ask(one);
  ASSERT_EQ(solved.state, ReplyState::kSolved) << solved.why.sentence;
  EXPECT_GT(synchronisations(), before + 1);
  const Reply cancelled = ask_to_cancel(never_sent.id);
  EXPECT_EQ(cancelled.state, ReplyState::kCancelled);
  kill_service();
  start();
  EXPECT_TRUE(says("remembers 3 earlier replies"));
  EXPECT_EQ(told(ask(one)), told(solved));
  EXPECT_EQ(told(ask(bad)), told(refused));
  EXPECT_EQ(told(ask(never_sent)), told(cancelled));
  expect_nothing_solved(3);
}

TEST_F(RememberTest, WhatIsRememberedMovesTheArmOnlyWhenItIsAsked) {
  start();
  connect();
  const auto executor = start_executor();
  wait_for_executor();
  const Order planned = order(kFast);
  EXPECT_EQ(ask(planned).state, ReplyState::kSolved);
  kill_service();
  start();
  wait_for_executor();
  Order execute = order("");
  execute.action = Action::kExecute;
  execute.trajectory_id = planned.id;
  const Reply first = ask(execute);
  ASSERT_EQ(first.state, ReplyState::kSolved) << first.why.sentence;
  ASSERT_TRUE(result_of(execute.id));
  kill_service();
  start();
  wait_for_executor();
  EXPECT_EQ(told(ask(execute)), told(first));
  settle();
  EXPECT_EQ(count(executor->output(), "finished id="), 1u);
  EXPECT_EQ(count(executor->output(), "refused"), 0u) << executor->output();
}

TEST_F(RememberTest, ADamagedRecordCostsItselfAlone) {
  start();
  connect();
  const Order damaged = order(kFast), intact = order(kRefused);
  const Reply whole = ask(damaged), refused = ask(intact);
  kill_service();
  Database(file(), Database::Access::kWrite).execute("PRAGMA wal_checkpoint(TRUNCATE)");
  std::string bytes = contents(file());
  const std::size_t at = bytes.find("\"certificate\": {");
  ASSERT_NE(at, bytes.npos);
  bytes[at + 3] ^= 1;
  std::ofstream(file(), std::ios::binary) << bytes;
  start();
  EXPECT_TRUE(says("a damaged reply is left out: " + to_text(damaged.id)));
  EXPECT_EQ(told(ask(intact)), told(refused));
  EXPECT_EQ(ask(damaged).state, ReplyState::kSolved);  // anew
  EXPECT_EQ(status_when([](const ServiceStatus& s) { return s.solved == 1; }).received, 1u);
}

TEST_F(RememberTest, ADamagedFileIsSetAside) {
  fs::create_directories(path("memory"));
  std::ofstream(file()) << std::string(8192, 'x');
  start();
  connect();
  EXPECT_TRUE(says("set aside as replies.sqlite.damaged"));
  const Order one = order(kRefused);
  const Reply refused = ask(one);
  kill_service();
  start();
  EXPECT_EQ(told(ask(one)), told(refused));
  expect_nothing_solved(1);
}

// Files may not grow beyond 32 KiB, as on a disk that is full; then they may.
TEST_F(RememberTest, AFullDiskKeepsNobodyFromHisAnswer) {
  write("limited.sh", "ulimit -S -f 64\nexec \"$@\"\n");
  start({"/bin/sh", path("limited.sh")});
  connect();
  std::vector<Order> orders;
  for (int i = 0; i < 3; ++i) orders.push_back(order(kFast));
  std::vector<Reply> replies;
  for (const Order& one : orders) {
    const auto asked = Clock::now();
    replies.push_back(ask(one));
    EXPECT_EQ(replies.back().state, ReplyState::kSolved);
    EXPECT_LT(seconds_since(asked), 1.5);  // nobody waits for a disk that takes nothing
  }
  EXPECT_EQ(count(log(), kNotRemembered), 1u) << log();

  rlimit limits{};
  ASSERT_EQ(::prlimit(pid(), RLIMIT_FSIZE, nullptr, &limits), 0);
  limits.rlim_cur = limits.rlim_max;
  ASSERT_EQ(::prlimit(pid(), RLIMIT_FSIZE, &limits, nullptr), 0);
  EXPECT_TRUE(says("remembered again"));
  EXPECT_EQ(count(log(), "remembered again"), 1u) << log();
  kill_service();
  start();
  for (std::size_t i = 0; i < orders.size(); ++i) {
    EXPECT_EQ(told(ask(orders[i])), told(replies[i]));
  }
  expect_nothing_solved(orders.size());
}

TEST_F(RememberTest, WithoutAFolderToWriteToTheServiceServes) {
  write("memory", "is no folder");
  start();
  connect();
  for (const auto began = Clock::now(); seconds_since(began) < 2.2;) {  // it is tried again every second
    EXPECT_EQ(ask(order(kRefused)).state, ReplyState::kRejected);
  }
  EXPECT_EQ(count(log(), kNotRemembered), 1u) << log();
}

// On disk there is what is in memory, and no more.
TEST_F(RememberTest, IsBoundedAsTheMemoryIs) {
  std::uint64_t number = 0;
  const auto remembered_before = [&] {
    ReplyCache cache(4, 1 << 20);
    ReplyStore store(path("memory"), "arm", [] {});
    const std::vector<SharedReply> earlier = store.take_earlier();
    for (const SharedReply& reply : earlier) cache.add(reply);
    for (int i = 0; i < 10; ++i) {
      Reply reply;
      reply.id.number = ++number;
      const auto shared = std::make_shared<const Reply>(reply);
      store.add(shared);
      for (const RequestId& id : cache.add(shared)) store.forget(id);
    }
    return earlier;
  };
  EXPECT_EQ(remembered_before().size(), 0u);
  EXPECT_EQ(remembered_before().size(), 4u);
  const auto last = remembered_before();
  ASSERT_EQ(last.size(), 4u);
  EXPECT_EQ(last.front()->id.number, 17u);
  EXPECT_EQ(last.back()->id.number, 20u);
}

}  // namespace
}  // namespace fjr
