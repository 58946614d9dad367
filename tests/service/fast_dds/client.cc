// A client of the planning service on Fast DDS:  fast_dds_client DOMAIN REFUSED GARBAGE
// Has REFUSED requests refused and one solved, after GARBAGE samples that are no requests at all.
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <random>
#include <thread>

#include "tests/service/fast_dds/types.h"

namespace {

using namespace eprosima::fastdds::dds;
using namespace eprosima::fastrtps::rtps;
using Clock = std::chrono::steady_clock;

// As the shipped configuration of Cyclone DDS: the loopback interface, and no multicast. All else is as it comes.
DomainParticipantQos on_loopback(unsigned domain) {
  DomainParticipantQos qos = PARTICIPANT_QOS_DEFAULT;
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  for (unsigned index = 0; index < 10; ++index) {
    Locator_t peer;
    IPLocator::setIPv4(peer, "127.0.0.1");
    peer.port = 7410 + 250 * domain + 2 * index;
    qos.wire_protocol().builtin.initialPeersList.push_back(peer);
  }
  return qos;
}

class Client {
 public:
  explicit Client(unsigned domain)
      : participant_(DomainParticipantFactory::get_instance()->create_participant(domain, on_loopback(domain))) {
    request_type_.register_type(participant_);
    reply_type_.register_type(participant_);
    std::random_device random;
    for (auto& byte : me_) byte = static_cast<std::uint8_t>(random());

    SubscriberQos mine = SUBSCRIBER_QOS_DEFAULT;
    mine.partition().push_back(name().c_str());
    DataReaderQos listening = DATAREADER_QOS_DEFAULT;
    listening.reliability().kind = RELIABLE_RELIABILITY_QOS;
    listening.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
    listening.endpoint().history_memory_policy = PREALLOCATED_WITH_REALLOC_MEMORY_MODE;  // replies differ much in size
    reader_ = participant_->create_subscriber(mine)->create_datareader(
        participant_->create_topic("fjr/plan_reply", "fjr::msg::PlanReply", TOPIC_QOS_DEFAULT), listening);

    DataWriterQos asking = DATAWRITER_QOS_DEFAULT;
    asking.reliability().kind = RELIABLE_RELIABILITY_QOS;
    asking.durability().kind = VOLATILE_DURABILITY_QOS;
    writer_ =
        participant_->create_publisher(PUBLISHER_QOS_DEFAULT)
            ->create_datawriter(
                participant_->create_topic("fjr/plan_request", "fjr::msg::PlanRequest", TOPIC_QOS_DEFAULT), asking);
  }
  ~Client() {
    participant_->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  bool find_service() const {
    PublicationMatchedStatus status;
    for (int i = 0; i < 1000; ++i) {
      writer_->get_publication_matched_status(status);
      if (status.current_count > 0) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

  // The final reply; asks again after half a second, as the protocol has it. State 0: none.
  fast_dds::Reply ask(double goal) {
    fast_dds::Request request;
    request.client = me_;
    request.number = ++number_;
    request.start = {0.3, 0.2};
    request.goal = {goal, 0.08};
    for (int attempt = 0; attempt < 20; ++attempt) {
      writer_->write(&request);
      for (const auto until = Clock::now() + std::chrono::milliseconds(500); Clock::now() < until;) {
        reader_->wait_for_unread_message({0, 50'000'000});
        fast_dds::Reply reply;
        SampleInfo info;
        while (reader_->take_next_sample(&reply, &info) == ReturnCode_t::RETCODE_OK) {
          if (info.valid_data && reply.number == number_ && reply.state > 1) return reply;
        }
      }
    }
    return {};
  }

  void send_garbage() {
    fast_dds::Request request;
    request.garbage.resize(random_() % 1200 + 1);
    for (auto& byte : request.garbage) byte = static_cast<std::uint8_t>(random_() % 7 == 0 ? random_() : 0);
    writer_->write(&request);
  }

 private:
  std::string name() const {
    std::string text;
    for (const auto byte : me_) {
      char digits[3];
      std::snprintf(digits, sizeof digits, "%02x", byte);
      text += digits;
    }
    return text;
  }

  TypeSupport request_type_{new fast_dds::Type<fast_dds::Request>("fjr::msg::PlanRequest", 2048)};
  TypeSupport reply_type_{new fast_dds::Type<fast_dds::Reply>("fjr::msg::PlanReply", 65536)};
  DomainParticipant* participant_;
  DataReader* reader_ = nullptr;
  DataWriter* writer_ = nullptr;
  fast_dds::Bytes me_{};
  std::uint64_t number_ = 0;
  std::mt19937 random_{1};
};

}  // namespace

int main(int, char** argv) {
  Client client(static_cast<unsigned>(std::atoi(argv[1])));
  if (!client.find_service()) return 1;
  for (int i = 0; i < std::atoi(argv[3]); ++i) client.send_garbage();
  int refused = 0;
  for (int i = 0; i < std::atoi(argv[2]); ++i) {
    const fast_dds::Reply reply = client.ask(3.4);
    if (reply.state == 2 && reply.field == "goal.q[0]") ++refused;
  }
  const fast_dds::Reply reply = client.ask(0.42);
  const bool ends_there = !reply.rows.empty() && std::abs(reply.rows.back()[1] - 0.42) < 1e-9;
  std::printf("refused=%d state=%d rows=%zu ends_there=%d\n", refused, reply.state, reply.rows.size(), ends_there);
}
