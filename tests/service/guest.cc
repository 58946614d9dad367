// Somebody on DDS, as whoever FJR_SECURITY says, who asks for a plan and listens:  guest DOMAIN SECONDS
// Prints what came of it: matched=0 heard=0 replies=0
#include <fmt/format.h>

#include <cstdlib>

#include "planner/dds/reader.h"
#include "planner/dds/wire_request.h"
#include "planner/dds/writer.h"
#include "tests/support/service_processes.h"

int main(int, char** argv) {
  using namespace fjr;
  fjr::Order order;
  order.id = new_client();
  order.name = "quick.yaml";
  order.document = kQuickRequest;

  const dds::Participant participant(static_cast<unsigned>(std::atoi(argv[1])));
  const dds::Entity subscriber = participant.subscriber(client_name(order.id));
  dds::Reader<fjr_msg_PlanReply> replies(participant, subscriber.handle());
  dds::Reader<fjr_msg_PlannerStatus> statuses(participant, participant.handle());
  dds::Writer<fjr_msg_PlanRequest> requests(participant, participant.handle());
  int heard = 0, answered = 0;
  bool matched = false;
  (void)comes_true(
      [&] {
        if (requests.has_reader() && !matched)
          matched = requests.write(dds::encode_plan_request(order).message.request);
        statuses.take_all([&](const auto&, const auto& info) { heard += info.valid_data ? 1 : 0; });
        replies.take_all([&](const auto&, const auto& info) { answered += info.valid_data ? 1 : 0; });
        return false;
      },
      std::atof(argv[2]));
  if (!matched)
    (void)requests.write(dds::encode_plan_request(order).message.request);  // for whoever may be there unmatched
  fmt::print("matched={:d} heard={} replies={}\n", matched, heard, answered);
}
