// Determines whether DDS messages of this process can reach other machines. It inspects the open sockets, because the
// configuration of DDS may come in many pieces and leave the choice of interfaces to DDS.
#pragma once

#include <set>
#include <string>

namespace fjr::dds {

// Returns what identifies the sockets of this process that are open now.
std::set<std::string> open_sockets();

// Counts the sockets that were opened since `before` as DDS's. Those from before are the process's own, which may be a
// server or a client of something else: nothing is concluded from them, and nothing is done to them. may_be_joined: the
// domain may be one that other code in this process has opened; if no socket was opened, its are used, and from then on
// all of the process count.
void note_opened_by_dds(const std::set<std::string>& before, bool may_be_joined);

// Returns whether DDS sends over the loopback interface only. A socket of unknown kind counts as one to the network.
bool sends_only_over_loopback();

// Makes DDS's sockets receive from the loopback interface only. By itself, DDS listens on every interface, wherever it
// sends.
void hear_only_loopback();

}  // namespace fjr::dds
