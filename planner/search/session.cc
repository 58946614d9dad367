#include "planner/search/session.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "common/parallel.h"

namespace fjr {
namespace {

// Returns the fraction of a request's work that may be done by the end of a phase.
double allowed_by_the_end_of(Phase phase, const BudgetSettings& settings) {
  switch (phase) {
    case Phase::kFinding:
      return settings.finding;
    case Phase::kRefining:
      return settings.refining;
    case Phase::kMargins:
    case Phase::kExplaining:
      return 1;
    case Phase::kDamping:
      return settings.damping;
  }
  throw std::logic_error("Phase out of range");
}

}  // namespace

Session::Session(SessionOptions options)
    : options_(std::move(options)), shared_(std::make_shared<Shared>(options_.jobs)) {}

Session::Session(Branch, const Session& trunk)
    : options_(trunk.options_),
      shared_(trunk.shared_),
      allowed_(trunk.allowed_),
      more_(trunk.more_),
      phase_(trunk.phase_) {
  iterations_before_ = trunk.iterations_before_ + trunk.account_.iterations;
  work_before_ = std::isfinite(allowed_) ? (trunk.work_ + trunk.allowed_) / 2 : trunk.work_;
  work_ = work_before_;
}

void Session::find_out_whether_stopped() {
  const std::lock_guard lock(shared_->callback);
  if (shared_->stopped) return;
  const double seconds = std::chrono::duration<double>(Clock::now() - shared_->began).count();
  shared_->deadline_passed = options_.deadline > 0 && seconds > options_.deadline;
  shared_->stopped = shared_->deadline_passed || (options_.cancelled && options_.cancelled());
}

bool Session::interrupted(double work) {
  work_ += work;
  shared_->work += work;
  find_out_whether_stopped();
  const bool spent = work_ >= allowed_;
  if (spent && !stopped()) account_.cut_by_work = true;
  return stopped() || spent;
}

// Adds the account of a branch; only its time if no more work was allowed by then.
PieceOfWork Session::join(const Session& branch) {
  if (work_ >= allowed_) {
    account_.add_time_of(branch.account_);
    return PieceOfWork::kIgnored;
  }
  work_ += branch.work_ - branch.work_before_;
  account_ += branch.account_;
  enter(branch.phase_);
  return PieceOfWork::kCounts;
}

std::vector<std::unique_ptr<Session>> Session::branches(std::size_t count) const {
  std::vector<std::unique_ptr<Session>> all;
  for (std::size_t i = 0; i < count; ++i) all.push_back(std::unique_ptr<Session>(new Session(Branch{}, *this)));
  return all;
}

std::vector<PieceOfWork> Session::join_all(const std::vector<std::unique_ptr<Session>>& branches) {
  std::vector<PieceOfWork> pieces;
  for (const auto& branch : branches) pieces.push_back(join(*branch));
  return pieces;
}

// Each branch measures its own time, and adds it to the part that this session is timing now.
std::function<void(std::size_t)> Session::in_branches(const std::vector<std::unique_ptr<Session>>& branches,
                                                      const std::function<void(std::size_t, Session&)>& task) const {
  if (innermost_ == nullptr) return [&](std::size_t i) { task(i, *branches[i]); };
  return [&, part = innermost_->part_](std::size_t i) {
    const Timed timed(*branches[i], part);
    task(i, *branches[i]);
  };
}

std::vector<PieceOfWork> Session::do_all(std::size_t count, const std::function<void(std::size_t, Session&)>& task) {
  if (count == 0) return {};
  if (count == 1) {
    task(0, *this);
    return {PieceOfWork::kCounts};
  }
  const auto own = branches(count);
  const auto work = in_branches(own, task);
  if (innermost_ != nullptr) innermost_->pause();
  for_each(count, work);
  if (innermost_ != nullptr) innermost_->go_on();
  return join_all(own);
}

std::vector<PieceOfWork> Session::do_beside(const std::function<void()>& own, std::size_t count,
                                            const std::function<void(std::size_t, Session&)>& task) {
  const auto beside = branches(count);
  const auto work = in_branches(beside, task);
  for_each(count + 1, [&](std::size_t i) {
    if (i > 0) return work(i - 1);
    own();
    if (innermost_ != nullptr) innermost_->pause();
  });
  if (innermost_ != nullptr) innermost_->go_on();
  return join_all(beside);
}

void Session::for_each(std::size_t count, const std::function<void(std::size_t)>& task) {
  account_.cpu_of_others += shared_->threads.for_each(count, task);
}

void Session::enter(Phase phase) {
  phase_ = std::max(phase_, phase);
  allowed_ = (allowed_by_the_end_of(phase_, settings().budget) + more_) * options_.most_work;
}

void Session::allow_more(double fraction) {
  more_ += fraction;
  allowed_ += fraction * options_.most_work;
}

void Session::tell_starts(int done, int planned) {
  shared_->starts = done;
  shared_->starts_planned = planned;
}

void Session::tell(Progress progress) const {
  if (!options_.on_progress) return;
  const std::lock_guard lock(shared_->callback);
  progress.phase = phase_;
  progress.iteration += iterations_before_ + account_.iterations;
  progress.objective *= options_.objective_scale;
  progress.starts = shared_->starts;
  progress.starts_planned = shared_->starts_planned;
  progress.work = shared_->work;
  progress.most_work = std::isfinite(options_.most_work) ? most_work() : 0;
  progress.deadline = options_.deadline;
  options_.on_progress(progress);
}

void Session::add(SolverStage stage) {
  stage.objective *= options_.objective_scale;
  account_.iterations += stage.iterations;
  account_.cost += stage.cost;
  account_.work += stage.work;
  account_.stages.push_back(std::move(stage));
}

Timed::Timed(Session& session, std::string part)
    : session_(session), part_(std::move(part)), around_(session.innermost_) {
  if (around_ != nullptr) around_->pause();
  session_.innermost_ = this;
}

Timed::~Timed() {
  pause();
  session_.innermost_ = around_;
  if (around_ != nullptr) around_->go_on();
}

void Timed::go_on() { since_ = Session::Clock::now(); }

void Timed::pause() {
  session_.account_.timing[part_] += std::chrono::duration<double>(Session::Clock::now() - since_).count();
}

}  // namespace fjr
