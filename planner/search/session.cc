#include "planner/search/session.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace fjr {
namespace {

// Of the work that a request may take, what may be done by the end of a phase.
double allowed_by_the_end_of(Phase phase) {
  switch (phase) {
    case Phase::kFinding:
      return 0.5;
    case Phase::kRefining:
      return 0.8;
    case Phase::kExplaining:
      return 1;
  }
  throw std::logic_error("Phase out of range");
}

}  // namespace

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

void Session::enter(Phase phase) {
  phase_ = std::max(phase_, phase);
  allowed_ = allowed_by_the_end_of(phase_) * options_.most_work;
}

void Session::tell(Progress progress) const {
  if (!options_.on_progress) return;
  progress.phase = phase_;
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
