// A client that can be killed at any point:  patient_client DOMAIN REQUEST
// Stops itself once it is served; continued, it asks for a motion, says so and waits.
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "planner/dds/client_port.h"
#include "tests/support/process.h"

int main(int, char** argv) {
  using namespace fjr;
  Order order;
  order.id = new_client();
  order.id.number = 1;
  order.name = argv[2];
  order.document = contents(argv[2]);
  order.action = Action::kPlanAndExecute;
  dds::ClientPort port(dds::Participant(static_cast<unsigned>(std::atoi(argv[1]))), order.id);
  while (!port.served()) port.wait(std::chrono::milliseconds(5));
  std::raise(SIGSTOP);
  if (!port.send(order)) return 1;
  std::puts("asked");
  std::fflush(stdout);
  for (;;) {
    port.wait(std::chrono::milliseconds(20));
    (void)port.take_replies();
  }
}
