#include "planner/search/session.h"

#include <algorithm>
#include <utility>

namespace fjr {

Session::Session(SessionOptions options) : options_(std::move(options)) {}

bool Session::interrupted(double work) {
  work_ += work;
  if (stopped_) return true;
  const double seconds = std::chrono::duration<double>(Clock::now() - began_).count();
  deadline_passed_ = options_.deadline > 0 && seconds > options_.deadline;
  stopped_ = deadline_passed_ || (options_.cancelled && options_.cancelled());
  const bool spent = work_ >= allowed_;
  if (spent && !stopped_) account_.cut_by_work = true;
  return stopped_ || spent;
}

void Session::allow(double fraction) { allowed_ = std::max(allowed_, fraction * options_.most_work); }

void Session::tell(Progress progress) const {
  if (!options_.on_progress) return;
  progress.iteration += account_.iterations;
  progress.objective *= options_.objective_scale;
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
  if (around_ != nullptr) around_->since_ = Session::Clock::now();
}

void Timed::pause() {
  session_.account_.timing[part_] += std::chrono::duration<double>(Session::Clock::now() - since_).count();
}

}  // namespace fjr
