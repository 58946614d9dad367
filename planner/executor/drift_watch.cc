#include "planner/executor/drift_watch.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <chrono>
#include <system_error>
#include <utility>

#include "common/input_error.h"
#include "common/parallel.h"
#include "planner/executor/execution_log.h"

namespace fjr {
namespace {

constexpr std::size_t kMostWaiting = 8;  // motions, with some MB each
constexpr int kLeastPriority = 19;       // lowest priority of a thread by nice(2)

}  // namespace

DriftWatch::DriftWatch(const Parameters& robot) : test_(robot) {}

DriftWatch::~DriftWatch() { unwanted_.request_stop(); }

void DriftWatch::add(const CommandedMotion& motion) {
  if (motion.outcome.ending != Ending::kReached) return;
  try {
    waiting_.push_back({motion.order.id, executed_motion(log_of(motion))});
  } catch (const InputError& error) {
    spdlog::info("id={} tells nothing of the arm: {}", text(motion.order.id), error.what());
  }
  if (waiting_.size() > kMostWaiting) waiting_.pop_front();
  if (!looking_.valid()) begin_next();
}

void DriftWatch::begin_next() {
  if (waiting_.empty()) return;
  Waiting next = std::move(waiting_.front());
  waiting_.pop_front();
  current_ = next.id;
  const auto look = [this, motion = std::move(next.motion), unwanted = unwanted_.get_token()] {
    (void)!nice(kLeastPriority);  // on Linux this affects the calling thread only
    return test_.look_at(motion, one_after_another, [&] { return unwanted.stop_requested(); });
  };
  try {
    looking_ = std::async(std::launch::async, look);
  } catch (const std::system_error& error) {  // no thread
    spdlog::warn("id={} is not looked at for drift: {}", text(current_), error.what());
  }
}

std::optional<ArmDrift> DriftWatch::look() {
  if (!looking_.valid() || looking_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  std::optional<ArmDrift> news;
  try {
    if (const auto look = looking_.get()) {
      test_.add(*look);
      looked_at_.push_back(current_);
      news = word();
    } else {
      spdlog::info("id={} tells nothing of the arm: its motors hardly move", text(current_));
    }
  } catch (const std::exception& error) {
    spdlog::warn("id={} is not looked at for drift: {}", text(current_), error.what());
  }
  begin_next();
  return news;
}

ArmDrift DriftWatch::word() const {
  ArmDrift drift;
  drift.motions = test_.motions();
  drift.drifts = test_.drifts();
  drift.evidence = test_.evidence();
  drift.alarm = kMotionsPerFalseAlarm;
  const auto cause = test_.cause();
  drift.parameter = cause->parameter;
  drift.unit = cause->unit;
  drift.share = cause->share;
  drift.known = cause->known;
  drift.change = cause->change;
  drift.change_error = cause->error;
  drift.since = looked_at_[cause->since];
  drift.motions_since = test_.motions() - cause->since;
  return drift;
}

}  // namespace fjr
