#include "planner/program/plan_pool.h"

#include <fmt/format.h>
#include <signal.h>

#include <chrono>
#include <exception>
#include <utility>

#include "common/bounded_json.h"
#include "planner/batch/statuses.h"
#include "planner/program/ending.h"

namespace fjr {
namespace {

using Clock = std::chrono::steady_clock;

constexpr timespec kRedraw{0, 500'000'000};  // of the progress line while nothing happens

struct Running {
  std::size_t item;
  PlanProcess process;
};

void start(const PlanPool& pool, std::size_t item, std::vector<Running>& running) {
  try {
    running.push_back({item, PlanProcess(pool.begin(item))});
  } catch (const std::exception& error) {
    pool.end(item, {error.what(), ""}, false);
  }
}

// Returns how many have ended.
std::size_t reap(const PlanPool& pool, std::vector<Running>& running, bool interrupted) {
  return std::erase_if(running, [&](Running& run) {
    const auto ending = run.process.ending();
    if (ending) pool.end(run.item, *ending, interrupted);
    return ending.has_value();
  });
}

// The time that is left is estimated from the mean of the finished requests; those under way count as half finished.
std::string progress(std::size_t done, std::size_t all, std::size_t running, Clock::time_point began) {
  const double elapsed = std::chrono::duration<double>(Clock::now() - began).count();
  const double behind = static_cast<double>(done) + static_cast<double>(running) / 2;
  std::string text = fmt::format("{} of {} planned, {} under way", done, all, running);
  if (done > 0)
    text += fmt::format(", about {} left", time_in_words(elapsed * (static_cast<double>(all) / behind - 1)));
  return text;
}

void wake_at_ended_children() {
  sigset_t child_ended;
  sigemptyset(&child_ended);
  sigaddset(&child_ended, SIGCHLD);
  ::signal(SIGCHLD, SIG_DFL);
  ::pthread_sigmask(SIG_BLOCK, &child_ended, nullptr);
}

void wait_for_a_child() {
  sigset_t child_ended;
  sigemptyset(&child_ended);
  sigaddset(&child_ended, SIGCHLD);
  ::sigtimedwait(&child_ended, nullptr, &kRedraw);
}

}  // namespace

PoolEnd PlanPool::plan(const std::vector<std::size_t>& items, ProgressLine& line) const {
  wake_at_ended_children();
  const Clock::time_point began = Clock::now();
  std::vector<Running> running;
  std::size_t done = 0;
  auto next = items.begin();
  int interruptions = 0;
  for (;;) {
    while (interruptions == 0 && next != items.end() && running.size() < jobs) start(*this, *next++, running);
    if (running.empty()) break;
    line.show(progress(done, items.size(), running.size(), began));
    wait_for_a_child();
    if (ending_signalled()) {
      ++interruptions;
      for (const Running& run : running) interruptions == 1 ? run.process.cancel() : run.process.kill();
    }
    done += reap(*this, running, interruptions > 0);
  }
  return {{next, items.end()}, interruptions > 0};
}

Row row_at_end(const BatchItem& item, const PlanEnding& ending, bool interrupted) {
  // A process that could not plan also writes JSON, but not about a request; it may succeed the next time.
  const auto plan = json_from_text<nlohmann::ordered_json>(ending.plan_json);
  if (plan.is_object() && plan.contains("request")) return make_row(item, plan);
  if (interrupted) return make_row(item, name(PlanStatus::kCancelled), "interrupted");
  return make_row(item, kFailedStatus, ending.words);
}

}  // namespace fjr
