// Determines whether DDS messages of this process can reach other machines. It inspects the open sockets, because the
// configuration of DDS may come in many pieces and leave the choice of interfaces to DDS.
#pragma once

#include <set>
#include <string>

namespace fjr::dds {

// Returns what identifies the sockets of this process that are open now.
std::set<std::string> open_sockets();

// Counts the sockets that were opened since `before` as DDS's. The others are the process's own, which may be a server
// or a client of something else: nothing is concluded from them, and nothing is done to them. (If DDS opened none, it
// uses those of another participant in this process, and all count.)
void note_opened_by_dds(const std::set<std::string>& before);

// Returns whether DDS sends over the loopback interface only. A socket of unknown kind counts as one to the network.
bool sends_only_over_loopback();

// Makes DDS's sockets receive from the loopback interface only. By itself, DDS listens on every interface, wherever it
// sends.
void hear_only_loopback();

}  // namespace fjr::dds
