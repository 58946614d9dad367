// Clients that ask as little as one can: each writes one request, once, as soon as anybody takes it, and waits for an
// answer. One after the other, each of them new to the domain; by turns with the newest type that services take and
// with the oldest:  first_requests DOMAIN COUNT Prints what came of it: answered=0 Or one that cancels a request,
// whoever hears it, and is gone:  first_requests DOMAIN cancel ID
#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "planner/dds/reader.h"
#include "planner/dds/wire_request.h"
#include "planner/dds/writer.h"
#include "tests/support/service_processes.h"

namespace {

using namespace fjr;

// What a process knows of others is forgotten with its last participant.
template <class Message, class Encode>
bool answered(unsigned domain, Encode&& encode) {
  Order order;
  order.id = new_client();
  order.name = "bad.yaml";
  order.document = kBadRequest;
  const dds::Participant participant(domain);
  const dds::Entity subscriber = participant.subscriber(client_name(order.id));
  dds::Reader<fjr_msg_PlanReply> replies(participant, subscriber.handle());
  dds::Writer<Message> requests(participant, participant.handle());
  if (!comes_true([&] { return requests.has_reader(); })) return false;
  if (!requests.write(encode(order))) return false;
  return comes_true(
      [&] {
        bool heard = false;
        replies.take_all([&](const auto&, const auto& info) { heard = heard || info.valid_data; });
        return heard;
      },
      5);
}

// Without taking leave, which would wait for whoever has not acknowledged it.
int cancel(unsigned domain, const RequestId& id) {
  const dds::Participant participant(domain);
  dds::Writer<fjr_msg_MotionCancel> cancels(participant, participant.handle());
  if (!comes_true([&] { return cancels.has_reader(); })) return 1;
  if (!cancels.write({dds::encode(id), "arm"})) return 1;
  (void)cancels.flush(DDS_MSECS(300));
  std::_Exit(0);
}

}  // namespace

int main(int, char** argv) {
  int count = 0;
  const auto domain = static_cast<unsigned>(std::atoi(argv[1]));
  if (std::string(argv[2]) == "cancel") return cancel(domain, request_id_from(argv[3]).value());
  const auto oldest = [](const Order& order) { return dds::encode_plan_request(order).message.request; };
  const auto newest = [](const Order& order) { return dds::encode(order); };
  for (int i = 0; i < std::atoi(argv[2]); ++i) {
    const bool heard =
        i % 2 == 0 ? answered<fjr_msg_MotionRequest>(domain, newest) : answered<fjr_msg_PlanRequest>(domain, oldest);
    count += heard ? 1 : 0;
  }
  fmt::print("answered={}\n", count);
}
