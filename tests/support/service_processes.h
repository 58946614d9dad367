// Tests with processes of fjr: a folder of the test's own, a DDS domain of the process's own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/domain.h"
#include "tests/support/process.h"

namespace fjr {

inline const std::string kQuickRequest =
    "start: {q: [0.3, 0.2]}\ngoal: {q: [0.42, 0.08]}\nobjective: fastest\n";           // 1 s
inline const std::string kBadRequest = "start: {q: [0, 0]}\ngoal: {q: [1.2, 3.4]}\n";  // refused at once

// Whether `holds` comes true within `limit` seconds.
template <class Holds>
bool comes_true(Holds holds, double limit = 10) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

// Runs a shell script in a network namespace of its own, as root there. Empty words: the system does not allow it.
inline std::vector<std::string> in_network_namespace(const std::string& script) {
  for (const char* how : {"-n", "-rn"}) {
    Process trial({"/usr/bin/unshare", how, "/bin/true"}, "/dev/null");
    if (trial.wait() == 0) return {"/usr/bin/unshare", how, "/bin/sh", "-c", script};
  }
  return {};
}

class ServiceProcesses : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    write("quick.yaml", kQuickRequest);
    write("bad.yaml", kBadRequest);
  }
  void TearDown() override {
    if (HasFailure()) {
      for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
        if (entry.path().extension() == ".log") std::fputs(contents(entry.path()).c_str(), stderr);
      }
    }
    std::filesystem::remove_all(folder_);
  }

  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }

  // fjr with these words in the test's domain; environment: NAME=value.
  std::unique_ptr<Process> fjr(std::vector<std::string> words, const std::string& log,
                               std::vector<std::string> environment = {}) const {
    std::vector<std::string> all = {"/usr/bin/env"};
    all.insert(all.end(), environment.begin(), environment.end());
    all.emplace_back(FJR_EXECUTABLE);
    all.insert(all.end(), words.begin(), words.end());
    all.insert(all.end(), {"--domain", std::to_string(domain_)});
    return std::make_unique<Process>(all, path(log));
  }

  // The same once it serves.
  std::unique_ptr<Process> serve(std::vector<std::string> words = {}, std::vector<std::string> environment = {}) const {
    words.insert(words.begin(), "serve");
    auto service = fjr(words, "serve.log", std::move(environment));
    EXPECT_TRUE(comes_true([&] { return service->output().find("serving") != std::string::npos; }));
    return service;
  }

  const unsigned domain_ = own_domain();

 private:
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("fjr_service_processes_" + std::to_string(::getpid()));
};

}  // namespace fjr
