// The other process of dds_test: counts requests until a cancellation comes, then tells:  dds_echo DOMAIN
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>

#include "planner/dds/reader.h"
#include "planner/dds/waitset.h"
#include "planner/dds/writer.h"

int main(int, char** argv) {
  using namespace fjr::dds;
  const Participant participant(static_cast<unsigned>(std::atoi(argv[1])));
  Waitset waitset(participant);
  Reader<fjr_msg_PlanRequest> requests(participant, participant.handle());
  Reader<fjr_msg_PlanCancel> cancels(participant, participant.handle());
  Writer<fjr_msg_PlannerStatus> statuses(participant, participant.handle());
  waitset.attach(requests.arrived());
  waitset.attach(cancels.arrived());
  fjr_msg_PlannerStatus status{};
  for (bool over = false; !over;) {
    waitset.wait(std::chrono::seconds(10));
    const auto count = [&] {
      requests.take_all([&](const fjr_msg_PlanRequest& request, const dds_sample_info_t& info) {
        if (!info.valid_data) return;
        ++status.received;
        for (std::uint32_t i = 0; i < request.via._length; ++i) status.uptime += request.via._buffer[i].time;
      });
    };
    count();
    cancels.take_all([&](const fjr_msg_PlanCancel&, const dds_sample_info_t& info) { over = info.valid_data; });
    if (over) count();
  }
  (void)statuses.write(status);
  (void)statuses.flush(DDS_SECS(2));
}
