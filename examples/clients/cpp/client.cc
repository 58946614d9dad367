// Has the motion of a request file planned and, with --execute, made by the arm:  client REQUEST.yaml [--execute]
#include <chrono>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fstream>
#include <iostream>
#include <random>

#include "fjr_msgsPubSubTypes.h"

using namespace eprosima::fastdds::dds;
using namespace fjr::msg;

// The sample for which `holds`, if one comes within that many seconds.
template <class T, class Holds>
bool wait_for(DataReader* reader, T& sample, double seconds, Holds holds) {
  using Clock = std::chrono::steady_clock;
  for (const auto end = Clock::now() + std::chrono::duration<double>(seconds); Clock::now() < end;) {
    reader->wait_for_unread_message({0, 50'000'000});
    for (SampleInfo info; reader->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK;) {
      if (info.valid_data && holds(sample)) return true;
    }
  }
  return false;
}

int main(int argc, char** argv) {
  std::ifstream file(argc > 1 ? argv[1] : "");
  if (!file) return std::cerr << "usage: client REQUEST.yaml [--execute]\n", 2;
  const bool execute = argc > 2 && std::string(argv[2]) == "--execute";
  MotionRequest request;
  request.document(std::string(std::istreambuf_iterator<char>(file), {}));
  request.action(execute ? ACTION_PLAN_AND_EXECUTE : ACTION_PLAN);
  request.id().number(1);
  std::random_device random;
  std::string partition;
  for (std::uint8_t& byte : request.id().client()) {
    byte = static_cast<std::uint8_t>(random());
    for (const int digit : {byte / 16, byte % 16}) partition += "0123456789abcdef"[digit];
  }

  DomainParticipant* all = DomainParticipantFactory::get_instance()->create_participant(0, PARTICIPANT_QOS_DEFAULT);
  const auto topic = [&](const char* name, TypeSupport type) {
    type.register_type(all);
    return all->create_topic(name, type.get_type_name(), TOPIC_QOS_DEFAULT);
  };
  SubscriberQos mine = SUBSCRIBER_QOS_DEFAULT;
  mine.partition().push_back(partition.c_str());
  const auto reader = [&](const SubscriberQos& subscriber, Topic* of) {
    DataReaderQos qos = DATAREADER_QOS_DEFAULT;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
    qos.history().kind = KEEP_ALL_HISTORY_QOS;
    qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_RESERVE_MEMORY_MODE;
    return all->create_subscriber(subscriber)->create_datareader(of, qos);
  };
  DataReader* replies = reader(mine, topic("fjr/plan_reply", TypeSupport(new PlanReplyPubSubType)));
  DataReader* results =
      reader(SUBSCRIBER_QOS_DEFAULT, topic("fjr/execution_result", TypeSupport(new ExecutionResultPubSubType)));
  Topic* requests = topic("fjr/motion_request", TypeSupport(new MotionRequestPubSubType));
  DataWriter* writer =
      all->create_publisher(PUBLISHER_QOS_DEFAULT)->create_datawriter(requests, DATAWRITER_QOS_DEFAULT);

  PlanReply reply;
  const auto ours = [&](const PlanReply& sample) { return sample.id() == request.id(); };
  for (int silence = 0; silence < 20 && reply.state() <= STATE_ACCEPTED; ++silence) {
    writer->write(&request);
    if (wait_for(replies, reply, 0.5, ours)) silence = 0;
  }
  if (reply.state() <= STATE_ACCEPTED) return std::cerr << "nobody answers: is the service running?\n", 1;
  if (reply.state() != STATE_SOLVED) return std::cerr << reply.field() << ": " << reply.sentence() << '\n', 3;
  const double duration = reply.rows().back().time();
  std::cout << "duration " << duration << " s, " << reply.rows().size() << " rows\n";
  if (!execute) return 0;
  ExecutionResult result;
  const auto of_ours = [&](const ExecutionResult& sample) { return sample.trajectory_id() == request.id(); };
  if (!wait_for(results, result, duration + 10, of_ours)) return std::cerr << "the executor has not reported\n", 1;
  std::cout << "executed: code " << result.error_code() << ' ' << result.sentence() << '\n';
  return result.error_code();
}
