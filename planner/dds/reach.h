// How far a process can be heard over DDS. The sockets that DDS has opened are asked: its configuration may come in
// many pieces and leave the choice to DDS.
#pragma once

namespace fjr::dds {

// Whether DDS sends over the loopback interface and no other. What is not recognised counts as the network.
bool sends_only_over_loopback();

// DDS listens on every interface wherever it sends: makes what is open now hear the loopback interface only.
void hear_only_loopback();

}  // namespace fjr::dds
