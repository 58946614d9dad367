// The layer over DDS: between two processes, within one, and when something is wrong.
#include <gmock/gmock.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <random>

#include "planner/dds/reader.h"
#include "planner/dds/waitset.h"
#include "planner/dds/writer.h"
#include "tests/support/service_processes.h"

namespace fjr::dds {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

class DdsTest : public ServiceProcesses {};

// Each reader lends samples in one size: bursts of any length, with sequences of any length, arrive as they were sent.
TEST_F(DdsTest, CarriesEverySampleToAnotherProcess) {
  Process echo({FJR_DDS_ECHO, std::to_string(domain_)}, path("echo.log"));
  const Participant participant(domain_);
  Writer<fjr_msg_PlanRequest> requests(participant, participant.handle());
  Writer<fjr_msg_PlanCancel> cancels(participant, participant.handle());
  Reader<fjr_msg_PlannerStatus> statuses(participant, participant.handle());
  ASSERT_TRUE(comes_true([&] { return requests.has_reader() && cancels.has_reader(); }));

  std::mt19937 random(1);
  std::array<fjr_msg_ViaPoint, fjr_msg_MAX_VIAS> vias{};
  double sum = 0;
  constexpr std::uint64_t kSamples = 2000;
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    fjr_msg_PlanRequest request{};
    request.via._length = request.via._maximum = static_cast<std::uint32_t>(random() % (vias.size() + 1));
    request.via._buffer = vias.data();
    for (std::uint32_t v = 0; v < request.via._length; ++v) sum += vias[v].time = static_cast<double>(random() % 1000);
    ASSERT_TRUE(comes_true([&] { return requests.write(request); }));  // false: the reader is behind
    if (random() % 40 == 0) std::this_thread::sleep_for(milliseconds(1));
  }
  ASSERT_TRUE(requests.flush(DDS_SECS(5)));
  ASSERT_TRUE(cancels.write({}));
  fjr_msg_PlannerStatus status{};
  ASSERT_TRUE(comes_true([&] {
    statuses.take_all([&](const fjr_msg_PlannerStatus& sample, const dds_sample_info_t& info) {
      if (info.valid_data) status = sample;
    });
    return status.received > 0;
  }));
  EXPECT_EQ(status.received, kSamples);
  EXPECT_EQ(status.uptime, sum);  // whole numbers
  EXPECT_EQ(echo.wait(), 0);
}

TEST_F(DdsTest, WaitsForSamplesWakesAndTime) {
  const Participant participant(domain_);
  Waitset waitset(participant);
  Reader<fjr_msg_PlanCancel> cancels(participant, participant.handle());
  Writer<fjr_msg_PlanCancel> writer(participant, participant.handle());
  waitset.attach(cancels.arrived());
  const auto waited = [&](std::chrono::nanoseconds limit) {
    const auto began = Clock::now();
    waitset.wait(limit);
    return Clock::now() - began;
  };
  EXPECT_GE(waited(milliseconds(50)), milliseconds(49));
  {
    const std::jthread other([&] {
      std::this_thread::sleep_for(milliseconds(20));
      waitset.wake();
    });
    EXPECT_LT(waited(std::chrono::seconds(20)), std::chrono::seconds(10));
  }
  waitset.wake();  // before the wait: not lost, and not felt twice
  EXPECT_LT(waited(std::chrono::seconds(20)), std::chrono::seconds(10));
  EXPECT_GE(waited(milliseconds(50)), milliseconds(49));
  ASSERT_TRUE(comes_true([&] { return writer.has_reader(); }));
  ASSERT_TRUE(writer.write({}));
  EXPECT_LT(waited(std::chrono::seconds(20)), std::chrono::seconds(10));
}

TEST_F(DdsTest, TellsErrorsApart) {
  const Participant participant(domain_);
  Writer<fjr_msg_PlanRequest> requests(participant, participant.handle());
  std::array<fjr_msg_ViaPoint, fjr_msg_MAX_VIAS + 1> vias{};
  fjr_msg_PlanRequest request{};
  request.via._length = request.via._maximum = vias.size();
  request.via._buffer = vias.data();
  const auto code_of = [](auto call) {
    try {
      call();
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::StartsWith("DDS: "));
      return error.code();
    }
    return DDS_RETCODE_OK;
  };
  EXPECT_EQ(code_of([&] { (void)requests.write(request); }), DDS_RETCODE_BAD_PARAMETER);
  EXPECT_EQ(code_of([&] { Entity(dds_create_subscriber(-1, nullptr, nullptr), "subscriber"); }),
            DDS_RETCODE_BAD_PARAMETER);
  dds_delete(requests.handle());
  EXPECT_EQ(code_of([&] { (void)requests.write({}); }), DDS_RETCODE_BAD_PARAMETER);
}

// Readers and writers of one partition do not meet those of another.
TEST_F(DdsTest, KeepsPartitionsApart) {
  const Participant participant(domain_);
  const Entity mine = participant.subscriber("mine"), to_others = participant.publisher("others");
  const Entity to_me = participant.publisher("mine");
  Reader<fjr_msg_PlanReply> replies(participant, mine.handle());
  Writer<fjr_msg_PlanReply> other(participant, to_others.handle()), same(participant, to_me.handle());
  EXPECT_TRUE(comes_true([&] { return same.has_reader(); }));
  EXPECT_FALSE(other.has_reader());
}

TEST_F(DdsTest, TakesPartAgainAfterItHasLeft) {
  for (int i = 0; i < 3; ++i) {
    const Participant first(domain_), second(domain_);
    Writer<fjr_msg_PlanCancel> writer(first, first.handle());
    Reader<fjr_msg_PlanCancel> reader(second, second.handle());
    EXPECT_TRUE(comes_true([&] { return writer.has_reader(); }));
  }
}

// DDS itself listens on every interface, whatever it is configured to send on.
TEST_F(DdsTest, HearsOnlyTheLoopbackInterface) {
  const Participant participant(domain_);
  int bound = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    sockaddr_storage name{};
    socklen_t size = sizeof name;
    const int descriptor = std::stoi(entry.path().filename());
    if (::getsockname(descriptor, reinterpret_cast<sockaddr*>(&name), &size) != 0 || name.ss_family != AF_INET)
      continue;
    if (reinterpret_cast<const sockaddr_in&>(name).sin_addr.s_addr != INADDR_ANY) continue;
    std::array<char, IF_NAMESIZE> device{};
    socklen_t length = device.size();
    EXPECT_EQ(::getsockopt(descriptor, SOL_SOCKET, SO_BINDTODEVICE, device.data(), &length), 0);
    EXPECT_STREQ(device.data(), "lo");
    ++bound;
  }
  EXPECT_GE(bound, 2);  // discovery and data
}

}  // namespace
}  // namespace fjr::dds
