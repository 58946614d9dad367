// Determines whether DDS messages of this process can reach other machines. It inspects the open sockets, because the
// configuration of DDS may come in many pieces and leave the choice of interfaces to DDS.
#pragma once

namespace fjr::dds {

// Returns whether DDS sends over the loopback interface only. A socket of unknown kind counts as one to the network.
bool sends_only_over_loopback();

// Makes all sockets that are open now receive from the loopback interface only. By itself, DDS listens on every
// interface, wherever it sends.
void hear_only_loopback();

}  // namespace fjr::dds
