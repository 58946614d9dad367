// Machines of a test: network namespaces on one switch, with cables that can be cut and networks that lose packets.
#pragma once

#include <sched.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/process.h"

namespace fjr {

// This process moves to a network namespace of its own, which has the switch: its children start there, and its own DDS
// uses it. Only root may do all that.
class Switch {
 public:
  explicit Switch(std::filesystem::path folder) : folder_(std::move(folder)) {
    if (::geteuid() != 0 || ::unshare(CLONE_NEWNET) != 0) return;
    up_ = run("ip link set lo up; ip link add br0 type bridge mcast_snooping 0; ip addr add 10.77.0.1/24 dev br0;"
              "ip link set br0 up") == 0;
    ::setenv("CYCLONEDDS_URI", uri().c_str(), 1);
    ::setenv("FJR_INTERFACE", "br0", 1);
  }

  bool up() const { return up_; }  // false: not allowed here

  // A machine with a network interface eth0.
  class Machine {
   public:
    Machine(const Switch& on, int number)
        : on_(on),
          cable_("cable" + std::to_string(number)),
          kernel_({"/usr/bin/unshare", "-n", "/bin/sleep", "infinity"}, on.folder_ / (cable_ + ".machine.log")) {
      while (std::filesystem::read_symlink(net()) == std::filesystem::read_symlink("/proc/self/ns/net")) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      const std::string address = "10.77.0." + std::to_string(number + 2);
      on_.run("ip link add " + cable_ + " type veth peer name eth0 netns " + std::to_string(kernel_.pid()) +
              "; ip link set " + cable_ + " master br0 up; nsenter --net=" + net() +
              " sh -ec 'ip link set lo up; ip addr add " + address + "/24 dev eth0; ip link set eth0 up'");
    }

    void cut() const { on_.run("ip link set " + cable_ + " down"); }
    void mend() const { on_.run("ip link set " + cable_ + " up"); }
    void lose(int of_thousand) const {  // packets that come in
      on_.run("nsenter --net=" + net() +
              " sh -ec 'nft add table inet lossy;"
              "nft add chain inet lossy input \"{ type filter hook input priority 0; }\";"
              "nft add rule inet lossy input meta l4proto udp numgen random mod 1000 \"<\" " +
              std::to_string(of_thousand) + " counter drop'");
    }

    // `words` on this machine.
    std::unique_ptr<Process> start(std::vector<std::string> words, const std::string& log) const {
      std::vector<std::string> all = {"/usr/bin/nsenter", "--net=" + net(), "/usr/bin/env", "FJR_INTERFACE=eth0"};
      all.insert(all.end(), words.begin(), words.end());
      return std::make_unique<Process>(all, on_.folder_ / log);
    }

   private:
    std::string net() const { return "/proc/" + std::to_string(kernel_.pid()) + "/ns/net"; }

    const Switch& on_;
    const std::string cable_;
    const Process kernel_;
  };

 private:
  static std::string uri() { return "file://" FJR_SOURCE_DIR "/config/cyclonedds-lab.xml"; }
  int run(const std::string& script) const {
    Process shell({"/bin/sh", "-ec", script}, folder_ / "network.log");
    const int code = shell.wait();
    if (code != 0) std::fputs((script + "\n" + shell.output()).c_str(), stderr);
    return code;
  }

  const std::filesystem::path folder_;
  bool up_ = false;
};

}  // namespace fjr
