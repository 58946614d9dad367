// fjr as a process in a folder of its own: what it returns, says and writes.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/process.h"

namespace fjr {

struct Result {
  int exit_code;  // -1: ended by a signal
  std::string out, err;
};

// A folder of its own, removed at the end, in which fjr runs.
class Cli : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  nlohmann::json plan_json(const std::string& folder = "out") const {
    return nlohmann::json::parse(contents(path(folder) / "plan.json"));
  }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(path(name).parent_path());
    std::ofstream(path(name), std::ios::binary) << text;
  }

  // Starts fjr in the test's folder.
  pid_t start(const std::vector<std::string>& arguments) const {
    std::vector<std::string> words = {FJR_EXECUTABLE};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    const auto open = [&](int descriptor, const std::filesystem::path& file) {
      posix_spawn_file_actions_addopen(&actions, descriptor, file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    };
    open(STDOUT_FILENO, path("stdout"));
    open(STDERR_FILENO, path("stderr"));
    if (std::filesystem::exists(path("stdin"))) {  // what the test has written as its standard input
      posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, path("stdin").c_str(), O_RDONLY, 0);
    }
    posix_spawn_file_actions_addchdir_np(&actions, folder_.c_str());
    pid_t child = -1;
    EXPECT_EQ(posix_spawn(&child, FJR_EXECUTABLE, &actions, nullptr, argv.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    return child;
  }

  Result finish(pid_t child) const {
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(path("stdout")), contents(path("stderr"))};
  }

  Result run(const std::vector<std::string>& arguments) const { return finish(start(arguments)); }

 private:
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("fjr_cli_test_" + std::to_string(::getpid()));
};

}  // namespace fjr
