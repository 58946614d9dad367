// Has the motion of a request file planned and, with --execute, made by the arm:  client REQUEST.yaml [--execute]
#include <chrono>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fstream>
#include <iostream>
#include <random>

#include "fjr_msgsPubSubTypes.h"

using namespace eprosima::fastdds::dds;
using namespace fjr::msg;
using Clock = std::chrono::steady_clock;

// The sample for which `holds`, if one comes within that many seconds.
template <class T, class Holds>
bool wait_for(DataReader* reader, T& sample, double seconds, Holds holds) {
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
  MotionRequest request;
  request.document(std::string(std::istreambuf_iterator<char>(file), {}));
  request.action(argc > 2 ? ACTION_PLAN_AND_EXECUTE : ACTION_PLAN);
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
  DataReaderQos reading = DATAREADER_QOS_DEFAULT;
  reading.reliability().kind = RELIABLE_RELIABILITY_QOS;
  reading.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
  SubscriberQos mine;
  mine.partition().push_back(partition.c_str());
  Topic* replied = topic("fjr/plan_reply", TypeSupport(new PlanReplyPubSubType));
  Topic* executed = topic("fjr/execution_result", TypeSupport(new ExecutionResultPubSubType));
  Topic* asked = topic("fjr/motion_request", TypeSupport(new MotionRequestPubSubType));
  DataReader* replies = all->create_subscriber(mine)->create_datareader(replied, reading);
  DataReader* results = all->create_subscriber(SUBSCRIBER_QOS_DEFAULT)->create_datareader(executed, reading);
  DataWriter* requests = all->create_publisher(PUBLISHER_QOS_DEFAULT)->create_datawriter(asked, DATAWRITER_QOS_DEFAULT);

  PlanReply reply;
  int silence = 0;  // in half seconds
  const auto answers = [&](const PlanReply& sample) {
    silence = 0;
    return sample.id() == request.id() && sample.state() != STATE_ACCEPTED && sample.reason() != REASON_QUEUE_FULL;
  };
  do requests->write(&request);
  while (!wait_for(replies, reply, 0.5, answers) && ++silence < 20);
  if (silence == 20) return std::cerr << "nobody answers: is the service running?\n", 1;
  if (reply.state() != STATE_SOLVED) return std::cerr << reply.field() << ": " << reply.sentence() << '\n', 3;
  std::cout << "duration " << reply.rows().back().time() << " s, " << reply.rows().size() << " rows\n";
  if (argc == 2) return 0;
  ExecutionResult result;
  const auto reports = [&](const ExecutionResult& sample) { return sample.trajectory_id() == request.id(); };
  if (!wait_for(results, result, 30, reports)) return std::cerr << "the executor has not reported\n", 1;
  std::cout << "executed: code " << result.error_code() << ' ' << result.sentence() << '\n';
  return result.error_code() == RESULT_SUCCESSFUL ? 0 : 1;
}
