// Clients that ask as little as one can: each writes one request, once, as soon as anybody takes it, and waits for an
// answer. One after the other, each of them new to the domain:  first_requests DOMAIN COUNT
// Prints what came of it: answered=0
#include <fmt/format.h>

#include <cstdlib>

#include "planner/dds/reader.h"
#include "planner/dds/wire_request.h"
#include "planner/dds/writer.h"
#include "tests/support/service_processes.h"

namespace {

using namespace fjr;

// What a process knows of others is forgotten with its last participant.
bool answered(unsigned domain) {
  Order order;
  order.id = new_client();
  order.name = "bad.yaml";
  order.yaml = kBadRequest;
  const dds::Participant participant(domain);
  const dds::Entity subscriber = participant.subscriber(client_name(order.id));
  dds::Reader<fjr_msg_PlanReply> replies(participant, subscriber.handle());
  dds::Writer<fjr_msg_PlanRequest> requests(participant, participant.handle());
  if (!comes_true([&] { return requests.has_reader(); })) return false;
  if (!requests.write(dds::encode_plan_request(order).message.request)) return false;
  return comes_true(
      [&] {
        bool heard = false;
        replies.take_all([&](const auto&, const auto& info) { heard = heard || info.valid_data; });
        return heard;
      },
      5);
}

}  // namespace

int main(int, char** argv) {
  int count = 0;
  for (int i = 0; i < std::atoi(argv[2]); ++i) count += answered(static_cast<unsigned>(std::atoi(argv[1]))) ? 1 : 0;
  fmt::print("answered={}\n", count);
}
