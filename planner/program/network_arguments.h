// --domain and --insecure-network, for every program that takes part in DDS.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "planner/protocol/network.h"

namespace fjr {

struct NetworkArguments {  // the command line takes precedence over the configuration
  std::optional<unsigned> domain;
  bool insecure_network = false;

  void apply_to(Network& network) const {
    if (domain) network.domain = *domain;
    network.allow_insecure_network = network.allow_insecure_network || insecure_network;
  }
};

inline void add_domain_option(CLI::App& command, NetworkArguments& to) {
  command.add_option("--domain", to.domain, "DDS domain")->check(CLI::Range(0, 230));
}

// Adds the options of programs that move or stop an arm, or have it moved or stopped.
inline void add_network_options(CLI::App& command, NetworkArguments& to) {
  add_domain_option(command, to);
  command.add_flag("--insecure-network", to.insecure_network,
                   "Use a network without DDS Security: everybody on it can have the arm moved");
}

}  // namespace fjr
