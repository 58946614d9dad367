// Whatever arrives, the service and the executor stay alive, answer those who make sense, and do not grow.
// FJR_FUZZ_SECONDS: how long for each kind of nonsense; a minute is enough to have found what there was.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <linux/if_ether.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <sys/socket.h>

#include <array>
#include <cstring>
#include <random>

#include "common/descriptor.h"
#include "planner/client/client.h"
#include "planner/dds/writer.h"
#include "planner/service/memory.h"
#include "tests/support/service_processes.h"

namespace fjr {
namespace {

using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::uint8_t>;
using testing::HasSubstr;

double fuzz_seconds() {
  const char* text = std::getenv("FJR_FUZZ_SECONDS");
  return text == nullptr ? 5 : std::atof(text);
}

class FuzzTest : public ServiceProcesses {
 protected:
  void SetUp() override {
    ServiceProcesses::SetUp();
    service_ = serve();
    executor_ = fjr({"executor", "--start", "0.3,0.2", "--state", path("state")}, "executor.log");
    ASSERT_TRUE(comes_true([&] { return executor_->output().find("executing for") != std::string::npos; }));
  }

  // The reply to a request from somebody who comes now.
  Reply ask(const std::string& yaml) const {
    Order order;
    order.id = new_client();
    order.name = "request.yaml";
    order.document = yaml;
    ClientOptions options;
    options.network.domain = domain_;
    options.network.allow_insecure_network = true;  // this process listens to packets, by a socket that is not DDS's
    options.find = 10;
    return request_plan(order, options).reply;
  }

  // Calls nonsense() for as long as is asked for, and a healthy client in between.
  template <class Nonsense>
  void withstand(Nonsense nonsense) {
    (void)ask(kBadRequest);
    for (int i = 0; i < 2000; ++i) nonsense();  // what there is to be learnt and allocated
    const std::uint64_t before = memory();
    const auto end = Clock::now() + std::chrono::duration<double>(fuzz_seconds());
    for (int healthy = 0; Clock::now() < end; ++healthy) {
      for (int i = 0; i < 2000; ++i) nonsense();
      ASSERT_EQ(ask(kBadRequest).why.field, "goal.q[1]") << "healthy client " << healthy;
      ASSERT_TRUE(alive());
    }
    const std::uint64_t after = memory();
    RecordProperty("grown_kB", static_cast<int>(after / 1024) - static_cast<int>(before / 1024));
    // Caches fill up (256 replies, 128 clients), DDS buffers and remembers who was there: 30 to 43 MB were seen, after
    // half a minute as after a whole one. What is allowed does not grow with time.
    EXPECT_LT(after, before + (96U << 20U)) << "service and executor grew from " << before;
    EXPECT_EQ(ask(kQuickRequest).state, ReplyState::kSolved);
    ASSERT_TRUE(alive());
  }

  bool alive() const { return ::kill(service_->pid(), 0) == 0 && ::kill(executor_->pid(), 0) == 0 && running(); }
  std::uint64_t memory() const { return resident_bytes(service_->pid()) + resident_bytes(executor_->pid()); }

  void expect_a_motion() {
    const auto request = fjr({"request", path("quick.yaml"), "--execute"}, "request.log");
    EXPECT_EQ(request->wait(), 0) << request->output();
    EXPECT_THAT(request->output(), HasSubstr("execution   code 0"));
  }

  std::uint32_t random() { return static_cast<std::uint32_t>(random_()); }
  std::size_t below(std::size_t bound) { return random_() % bound; }

  std::unique_ptr<Process> service_, executor_;

 private:
  // A process that has ended stays there, as a zombie, until it is waited for.
  bool running() const {
    for (const auto& process : {&service_, &executor_}) {
      const std::string stat = contents("/proc/" + std::to_string((*process)->pid()) + "/stat");
      if (stat.empty() || stat[stat.rfind(')') + 2] == 'Z') return false;
    }
    return true;
  }

  std::mt19937 random_{20};
};

// ---- packets ----

class Eavesdropper {
 public:
  explicit Eavesdropper(unsigned domain)
      : first_port_(7400 + 250 * domain), socket_(::socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, htons(ETH_P_IP))) {
    // What other tests send at the same time is in it, too.
    constexpr int kRoom = 64 << 20;
    (void)::setsockopt(socket_.number(), SOL_SOCKET, SO_RCVBUFFORCE, &kRoom, sizeof kRoom);
  }

  bool allowed() const { return socket_.number() >= 0; }

  // RTPS packets of the domain that have passed since the last time, some of them.
  void listen(std::vector<Bytes>& to) {
    std::array<std::uint8_t, 65536> packet;
    for (;;) {
      const ssize_t size = ::recv(socket_.number(), packet.data(), packet.size(), MSG_DONTWAIT);
      if (size < 0) return;
      const std::size_t headers = std::size_t{packet[0] & 15U} * 4 + sizeof(udphdr);
      if (packet[9] != IPPROTO_UDP || static_cast<std::size_t>(size) <= headers) continue;
      const unsigned port = packet[headers - 6] * 256U + packet[headers - 5];
      if (port < first_port_ || port >= first_port_ + 250) continue;
      if (to.size() >= 4000) to.erase(to.begin());
      to.emplace_back(packet.data() + headers, packet.data() + size);
    }
  }

 private:
  unsigned first_port_;
  Descriptor socket_;
};

// Where the process receives, by its sockets' numbers.
std::vector<std::uint16_t> udp_ports(pid_t process) {
  std::vector<std::uint16_t> ports;
  std::istringstream table(contents("/proc/net/udp"));
  std::string line;
  while (std::getline(table, line)) {
    std::istringstream words(line);
    std::string slot, local, word, inode;
    words >> slot >> local;
    for (int i = 0; i < 8; ++i) words >> inode;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/fd")) {
      std::error_code gone;
      if (std::filesystem::read_symlink(entry, gone) != "socket:[" + inode + "]") continue;
      ports.push_back(static_cast<std::uint16_t>(std::stoul(local.substr(local.find(':') + 1), nullptr, 16)));
    }
  }
  return ports;
}

TEST_F(FuzzTest, WithstandsPackets) {
  Eavesdropper eavesdropper(domain_);
  if (!eavesdropper.allowed()) GTEST_SKIP() << "packets may not be captured here";
  std::vector<std::uint16_t> ports = udp_ports(service_->pid());
  for (const std::uint16_t port : udp_ports(executor_->pid())) ports.push_back(port);
  ASSERT_GE(ports.size(), 4u);
  expect_a_motion();
  std::vector<Bytes> heard;
  eavesdropper.listen(heard);
  ASSERT_GT(heard.size(), 50u);

  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM, 0));
  const auto changed = [&](Bytes packet) {
    constexpr std::array<std::uint8_t, 6> kEdges = {0, 1, 0x7f, 0x80, 0xfe, 0xff};
    for (std::size_t changes = 1 + below(6); changes > 0 && !packet.empty(); --changes) {
      const std::size_t at = below(packet.size());
      switch (below(6)) {
        case 0:
          packet[at] = static_cast<std::uint8_t>(random());
          break;
        case 1:
          packet[at] = kEdges[below(kEdges.size())];
          break;
        case 2:
          packet[at] ^= static_cast<std::uint8_t>(1U << below(8));
          break;
        case 3:
          packet.resize(at);
          break;
        case 4:  // a part of another one
          if (const Bytes& other = heard[below(heard.size())]; other.size() > 20) {
            packet.insert(packet.end(), other.begin() + 20, other.end());
          }
          break;
        default:  // four bytes that may be a length
          for (std::size_t i = at; i < std::min(at + 4, packet.size()); ++i) packet[i] = kEdges[below(kEdges.size())];
      }
    }
    packet.resize(std::min<std::size_t>(packet.size(), 60000));
    return packet;
  };
  std::size_t sent = 0;
  withstand([&] {
    Bytes packet;
    if (below(10) == 0) {
      packet = {'R', 'T', 'P', 'S', 2, 1, 1, 16};
      packet.resize(8 + below(300));
      for (std::size_t i = 8; i < packet.size(); ++i) packet[i] = static_cast<std::uint8_t>(random());
    } else {
      packet = changed(heard[below(heard.size())]);
    }
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(ports[below(ports.size())]);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    (void)::sendto(socket.number(), packet.data(), packet.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
    if (++sent % 500 == 0) eavesdropper.listen(heard);
  });
  RecordProperty("packets", static_cast<int>(sent));
}

// ---- samples ----

// A sample of a type without pointers, with any bytes but booleans, which DDS itself checks.
class FuzzSamples : public FuzzTest {
 protected:
  double number() {
    constexpr std::array<double, 10> kEdges = {0, -0.0, 1, -1, 1e308, -1e308, 5e-324, 1e-300, 3.141, 1e18};
    switch (below(4)) {
      case 0:
        return std::numeric_limits<double>::quiet_NaN();
      case 1:
        return below(2) == 0 ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
      case 2:
        return kEdges[below(kEdges.size())];
      default:
        return (static_cast<double>(random()) / 4e9 - 0.5) * 4;
    }
  }
  bool flag() { return below(2) == 0; }
  std::uint8_t octet() { return static_cast<std::uint8_t>(below(3) == 0 ? random() : below(4)); }

  template <std::size_t N>
  void fill(char (&text)[N]) {
    for (char& c : text) c = static_cast<char>(1 + random() % 255);
    if (below(4) != 0) text[below(N)] = '\0';  // else it has no end
  }
  template <std::size_t N>
  void fill(double (&values)[N]) {
    for (double& value : values) value = number();
  }
  void fill(fjr_msg_RequestId& id) {
    // Cyclone DDS keeps some memory for every writer there ever was, and each client has two of them: not endlessly
    // many.
    id.client[0] = static_cast<std::uint8_t>(below(100));
    id.number = below(2) == 0 ? below(100) : random();
  }
  template <class T>
  void fill_items(std::vector<T>& items, std::size_t most) {
    items.resize(below(most + 1));
    for (T& item : items) fill(item);
  }
  void fill(fjr_msg_ViaPoint& via) {
    via = {flag(), number(), {}, flag(), {}};
    fill(via.q);
    fill(via.dq);
  }
  void fill(fjr_msg_ExecutedRow& row) {
    row.time = number();
    for (auto* pair : {&row.q, &row.theta, &row.tau, &row.planned_q, &row.planned_theta}) fill(*pair);
  }
  void fill(fjr_msg_Disc& disc) {
    fill(disc.center);
    disc.radius = number();
    disc.margin = number();
  }
  void fill(fjr_msg_Row& row) {
    row.time = number();
    for (auto* pair : {&row.q, &row.dq, &row.theta, &row.dtheta, &row.tau}) fill(*pair);
  }

  void fill(fjr_msg_Posture& posture) { fill(posture.q); }

  void fill(fjr_msg_PlanRequest2& extended) {
    extended.goal_dq_free = below(4) == 0;
    extended.has_release = below(4) == 0;
    extended.release = static_cast<std::uint32_t>(below(3));
    for (double* weight : {&extended.copper, &extended.peak_torque, &extended.tip_speed}) *weight = number();
    extended.path.given = below(4) == 0;
    extended.path.tolerance = number();
    fjr_msg_PlanRequest& r = extended.request;
    fill(r.id);
    fill(r.trajectory_id);
    r.action = octet();
    fill(r.robot_id);
    if (below(4) == 0) fill(r.robot_hash);
    fill(r.name);
    r.priority = static_cast<std::int32_t>(random());
    r.budget = below(3) == 0 ? number() : 0.05;
    r.start.given = below(4) != 0;
    r.start.has_dq = below(8) == 0;
    r.goal.kind = octet();
    r.goal.has_tip_velocity = flag();
    r.goal.elbow = octet();
    r.goal.q_free[below(2)] = below(4) == 0;
    for (auto* pair : {&r.start.q, &r.start.dq, &r.goal.q, &r.goal.tip, &r.goal.tip_velocity}) fill(*pair);
    r.duration = {flag(), number(), flag(), number()};
    r.objective = {octet(), number(), number(), number(), number(), number(), number()};
    r.tip.kind = octet();
    for (auto* pair : {&r.tip.lower, &r.tip.upper, &r.tip.from, &r.tip.to, &r.tip.center}) fill(*pair);
    r.limits.has_torque = flag();
    fill(r.limits.torque);
    r.limits.has_tip_speed = flag();
    r.limits.tip_speed = number();
    r.payload = {flag(), number(), number()};
    r.has_sample_period = flag();
    r.sample_period = number();
    r.has_seed = flag();
    r.seed = random();
  }
};

TEST_F(FuzzSamples, WithstandsRequestsAndTrajectories) {
  const dds::Participant participant(domain_);
  dds::Writer<fjr_msg_PlanRequest> requests(participant, participant.handle());
  dds::Writer<fjr_msg_PlanRequest2> extended_requests(participant, participant.handle());
  dds::Writer<fjr_msg_PlanCancel> cancels(participant, participant.handle());
  dds::Writer<fjr_msg_Trajectory> trajectories(participant, participant.handle());
  dds::Writer<fjr_msg_LearntTrajectory> learnt_trajectories(participant, participant.handle());
  dds::Writer<fjr_msg_ExecutedRun> runs(participant, participant.handle());
  ASSERT_TRUE(comes_true([&] {
    return requests.has_reader() && extended_requests.has_reader() && cancels.has_reader() &&
           trajectories.has_reader() && learnt_trajectories.has_reader() && runs.has_reader();
  }));
  std::vector<fjr_msg_ViaPoint> vias;
  std::vector<fjr_msg_Disc> discs;
  std::vector<fjr_msg_Posture> postures;
  std::vector<fjr_msg_Row> rows;
  std::vector<fjr_msg_ExecutedRow> ticks;
  const auto trajectory_of = [&](auto trajectory) {
    fill(trajectory.robot_id);
    if (flag()) std::strcpy(trajectory.robot_id, "arm");
    fill(trajectory.id);
    trajectory.epoch = random() % 2;
    trajectory.published = std::numeric_limits<std::int64_t>::min() + random();
    fill(trajectory.robot_hash);
    trajectory.certified = trajectory.ends_at_rest = flag();
    fill_items(rows, 60);
    trajectory.rows = {static_cast<std::uint32_t>(rows.size()), static_cast<std::uint32_t>(rows.size()), rows.data(),
                       false};
    return trajectory;
  };
  std::size_t sent = 0;
  withstand([&] {
    switch (++sent % 5) {
      case 0: {
        fjr_msg_PlanCancel cancel{};
        fill(cancel.id);
        (void)cancels.write(cancel);
        break;
      }
      case 1: {
        if (flag()) {
          (void)trajectories.write(trajectory_of(fjr_msg_Trajectory{}));
        } else {
          (void)learnt_trajectories.write(trajectory_of(fjr_msg_LearntTrajectory{}));
        }
        break;
      }
      case 2: {
        fjr_msg_ExecutedRun run{};
        fill(run.robot_id);
        if (flag()) std::strcpy(run.robot_id, "arm");
        fill(run.trajectory_id);
        fill(run.robot_hash);
        fill(run.sentence);
        fill_items(ticks, 60);
        const auto count = static_cast<std::uint32_t>(ticks.size());
        run.rows = {count, count, ticks.data(), false};
        (void)runs.write(run);
        break;
      }
      default: {
        fjr_msg_PlanRequest2 extended{};
        fill(extended);
        fjr_msg_PlanRequest& request = extended.request;
        fill_items(vias, below(8) == 0 ? fjr_msg_MAX_VIAS : 0);
        fill_items(discs, below(8) == 0 ? fjr_msg_MAX_OBSTACLES : 0);
        request.via = {static_cast<std::uint32_t>(vias.size()), static_cast<std::uint32_t>(vias.size()), vias.data(),
                       false};
        request.obstacles = {static_cast<std::uint32_t>(discs.size()), static_cast<std::uint32_t>(discs.size()),
                             discs.data(), false};
        fill_items(postures, below(8) == 0 ? fjr_msg_MAX_PATH_POINTS : 0);
        const auto count = static_cast<std::uint32_t>(postures.size());
        extended.path.points = {count, count, postures.data(), false};
        (void)(flag() ? requests.write(request) : extended_requests.write(extended));
      }
    }
  });
  RecordProperty("samples", static_cast<int>(sent));
  EXPECT_EQ(executor_->output().find("executing id="), std::string::npos);
}

}  // namespace
}  // namespace fjr
