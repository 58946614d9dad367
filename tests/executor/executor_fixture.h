// An executor as a process, and who publishes trajectories to it.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "planner/dds/reader.h"
#include "planner/dds/waitset.h"
#include "planner/dds/wire_execution.h"
#include "planner/dds/writer.h"
#include "tests/executor/flat_motion.h"
#include "tests/support/domain.h"
#include "tests/support/process.h"

namespace fjr {

inline const Joints<double> kFrom{0.3, 0.2}, kTo{0.9, -0.3};
inline const Joints<double> kBeyond{0.9, -0.9};  // from kFrom in 3 and 5 s, motor 2 rests nowhere for long: certified

inline const Parameters& robot() {
  static const Parameters p = load_parameters(default_robot_file());
  return p;
}

inline unsigned domain() { return own_domain(); }

inline std::int64_t nanoseconds_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

// Who publishes trajectories and listens: in the place of the service.
class ExecutorCell {
 public:
  ExecutorCell()
      : participant_(domain()),
        states_(participant_, participant_.handle()),
        results_(participant_, participant_.handle()),
        trajectories_(participant_, participant_.handle()) {}

  // A flat motion under a new id, as a service would publish it.
  TrajectoryOrder order(const Joints<double>& from, const Joints<double>& to, double duration) {
    TrajectoryOrder order;
    order.robot_id = "arm";
    order.id = me_;
    order.id.number = ++last_;
    order.published = nanoseconds_now();
    order.robot_hash = robot_hash(robot());
    order.certified = order.ends_at_rest = true;
    order.rows = flat_motion(robot(), from, to, duration).samples;
    return order;
  }
  RequestId publish(const TrajectoryOrder& order) {
    EXPECT_TRUE(trajectories_.write(dds::encode(order)));
    return order.id;
  }
  // On both topics, as services do, the older one first.
  RequestId publish_with_stops(const TrajectoryOrder& order) {
    if (!trajectories_2_) {
      trajectories_2_.emplace(participant_, participant_.handle());
      EXPECT_TRUE(wait([this](const ExecutorState&) { return trajectories_2_->has_reader(); }));
    }
    EXPECT_TRUE(trajectories_.write(dds::encode(order)));
    EXPECT_TRUE(trajectories_2_->write(dds::encode_2(order)));
    return order.id;
  }
  RequestId publish(const Joints<double>& from, const Joints<double>& to, double duration) {
    return publish(order(from, to, duration));
  }

  // Until `there` holds of the latest state; false: not within 20 s.
  template <class There>
  bool wait(There&& there) {
    for (int i = 0; i < 20'000; ++i) {
      listen();
      if (there(state)) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  bool wait_for(ExecutorMode mode) {
    return wait([mode](const ExecutorState& s) { return s.mode == mode && !s.robot_id.empty(); });
  }
  bool wait_for_time(double time) {
    return wait([time](const ExecutorState& s) { return s.mode == ExecutorMode::kExecuting && s.time > time; });
  }

  ExecutionResult result(const RequestId& id) {
    EXPECT_TRUE(wait([&](const ExecutorState&) { return results.contains(id); }));
    return results[id].empty() ? ExecutionResult{} : results[id].back();
  }

  // A while in which nothing is to happen.
  void listen_for(double seconds) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < until) {
      listen();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  ExecutorState state;
  std::map<RequestId, std::vector<ExecutionResult>> results;
  Joints<double> farthest{};  // [rad] from kFrom

 private:
  void listen() {
    states_.take_all([this](const fjr_msg_ExecutorState& message, const dds_sample_info_t& info) {
      if (!info.valid_data) return;
      state = dds::decode(message);
      for (std::size_t j = 0; j < kJoints; ++j) farthest[j] = std::max(farthest[j], std::abs(state.q[j] - kFrom[j]));
    });
    results_.take_all([this](const fjr_msg_ExecutionResult& message, const dds_sample_info_t& info) {
      if (!info.valid_data) return;
      ExecutionResult result = dds::decode(message);
      results[result.trajectory_id].push_back(std::move(result));
    });
  }

  dds::Participant participant_;
  dds::Reader<fjr_msg_ExecutorState> states_;
  dds::Reader<fjr_msg_ExecutionResult> results_;
  dds::Writer<fjr_msg_Trajectory> trajectories_;
  std::optional<dds::Writer<fjr_msg_Trajectory2>> trajectories_2_;
  RequestId me_ = new_client();
  std::uint64_t last_ = 0;
};

class ExecutorTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    write("there.yaml", "start: {q: [0.3, 0.2]}\ngoal: {q: [0.42, 0.08]}\nobjective: fastest\n");
  }
  void TearDown() override {
    cell_.reset();
    if (HasFailure()) std::fputs(contents(path("executor.log")).c_str(), stderr);
    std::filesystem::remove_all(folder_);
  }

  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }

  Process fjr(std::vector<std::string> words, const std::string& log) const {
    words.insert(words.begin(), FJR_EXECUTABLE);
    words.insert(words.end(), {"--domain", std::to_string(domain())});
    return Process(words, path(log));
  }
  std::unique_ptr<Process> executor(std::vector<std::string> options = {}) {
    std::vector<std::string> words{FJR_EXECUTABLE, "executor",    "--domain", std::to_string(domain()),
                                   "--state",      path("state"), "--logs",   path("logs")};
    words.insert(words.end(), options.begin(), options.end());
    if (std::find(words.begin(), words.end(), "--config") == words.end()) {
      words.insert(words.end(), {"--start", "0.3,0.2"});
    }
    return std::make_unique<Process>(words, path("executor.log"));
  }
  // The cell, with the executor resting.
  ExecutorCell& cell() {
    if (!cell_) cell_ = std::make_unique<ExecutorCell>();
    return *cell_;
  }

  void forget_cell() { cell_.reset(); }

 private:
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("fjr_executor_test_" + std::to_string(::getpid()));
  std::unique_ptr<ExecutorCell> cell_;
};

}  // namespace fjr
