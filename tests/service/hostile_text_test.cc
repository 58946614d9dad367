// What others send ends up in logs and on terminals: as visible text on one line, and not once for every packet.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>

#include "planner/dds/reader.h"
#include "planner/dds/text.h"
#include "planner/dds/wire_request.h"
#include "planner/dds/writer.h"
#include "tests/support/service_processes.h"

namespace fjr {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kHostile = "x\n2026-01-01T00:00:00.000 info owner\x1b[2J\x1b]0;owned\x07\xc3\x28\xe2\x80\xae";
const std::string kShown = "x\\n2026-01-01T00:00:00.000 info owner\\u001b[2J\\u001b]0;owned\\u0007\\xc3(\\u202e";

TEST(Printable, EscapesWhatIsNotVisibleOnOneLine) {
  EXPECT_EQ(printable(kHostile), kShown);
  EXPECT_EQ(printable("Zelle 1: Größe 3 µm, 机器人, \\ \" '"), "Zelle 1: Größe 3 µm, 机器人, \\ \" '");
  EXPECT_EQ(printable("\t\r\x7f\xc2\x9b"), "\\t\\r\\u007f\\u009b");
  // Cut short, too long, a surrogate, beyond Unicode.
  EXPECT_EQ(printable("\xe2\x82"), "\\xe2\\x82");
  EXPECT_EQ(printable("\xc0\xaf\xe0\x80\xaf"), "\\xc0\\xaf\\xe0\\x80\\xaf");
  EXPECT_EQ(printable("\xed\xa0\x80\xf4\x90\x80\x80"), "\\xed\\xa0\\x80\\xf4\\x90\\x80\\x80");
  EXPECT_EQ(printable_lines("{\n \"a\": \"\x1b\"\n}"), "{\n \"a\": \"\\u001b\"\n}");
}

class HostileTextTest : public ServiceProcesses {};

TEST_F(HostileTextTest, IsShownAsTextOnOneLine) {
  const auto service = serve();
  const dds::Participant participant(domain_);
  dds::Writer<fjr_msg_PlanRequest> requests(participant, participant.handle());
  dds::Writer<fjr_msg_PlannerStatus> statuses(participant, participant.handle());
  fjr_msg_PlannerStatus status{};
  dds::set_text(status.instance, kHostile);
  ASSERT_TRUE(statuses.write(status));
  ASSERT_TRUE(comes_true([&] { return requests.has_reader(); }));
  Order order;
  order.id = new_client();
  order.name = "quick.yaml";
  order.document = kQuickRequest;
  fjr_msg_PlanRequest request = dds::encode_plan_request(order).message.request;
  dds::set_text(request.name, kHostile);
  ASSERT_TRUE(requests.write(request));
  EXPECT_TRUE(comes_true([&] { return service->output().find("name=" + kShown) != std::string::npos; }))
      << service->output();
  const auto seen = fjr({"status"}, "status.log");
  EXPECT_EQ(seen->wait(), 0);
  EXPECT_THAT(seen->output(), HasSubstr(kShown));
  EXPECT_THAT(service->output() + seen->output(), Not(HasSubstr("\x1b")));
}

// Where the first participant of a domain listens for data: 7400 + 250 for each domain + 11.
void send_malformed(unsigned domain, int count) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * domain + 11));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::array<unsigned char, 60> packet{'R', 'T', 'P', 'S', 2, 1, 1, 16};
  packet[20] = 0x15;  // DATA that goes on beyond the packet
  packet[21] = 0x05;
  packet[22] = 0xff;
  for (int i = 0; i < count; ++i) {
    ::sendto(socket, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
    if (i % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ::close(socket);
}

TEST_F(HostileTextTest, MalformedPacketsAreCounted) {
  const auto service = serve();
  constexpr int kPackets = 3000;
  send_malformed(domain_, kPackets);
  const auto told = [&] {  // how many packets, in how many lines
    const std::string log = service->output(), words = " malformed packets or samples within a second";
    std::pair<int, int> sum;
    for (std::size_t at = 0; (at = log.find(words, at)) != std::string::npos; ++at) {
      sum.first += std::stoi(log.substr(log.rfind(' ', at - 1) + 1));
      ++sum.second;
    }
    return sum;
  };
  EXPECT_TRUE(comes_true([&] { return told().first >= kPackets; })) << service->output();
  EXPECT_LE(told().second, 10);
  EXPECT_LE(std::ranges::count(service->output(), '\n'), 20);
}

}  // namespace
}  // namespace fjr
