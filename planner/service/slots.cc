#include "planner/service/slots.h"

#include <chrono>

namespace fjr {
namespace {

constexpr std::chrono::milliseconds kRelease{50};  // until workers have heard that their jobs are no longer needed

}  // namespace

// elsewhere_ is kept when the ownership ends, because disconnecting from a worker that does not answer takes up to 1 s.
void Slots::own(const dds::Participant& participant, dds::Waitset& waitset, RemoteSolvers::Owner owner,
                std::uint64_t epoch) {
  if (!elsewhere_) elsewhere_.emplace(participant, waitset, std::move(owner));
  elsewhere_->own(epoch);
  owner_ = true;
}

void Slots::disown() {
  if (!owner_) return;
  owner_ = false;
  while (elsewhere_->stop_if([](const Job&) { return true; })) {
  }
  elsewhere_->flush(kRelease);
}

std::optional<Job> Slots::solve(Job job) {
  const auto elsewhere = owner_ ? elsewhere_->load() : std::nullopt;
  // The workers elsewhere may have gone since may_solve() was asked, or this job cannot go there.
  if ((!elsewhere || solved_here(job)) && !here_.may_solve()) return job;
  if (!elsewhere || solved_here(job) || (here_.may_solve() && here_.load() <= *elsewhere)) {
    here_.solve(std::move(job));
    return std::nullopt;
  }
  return elsewhere_->solve(std::move(job));
}

Solvers::News Slots::take_news() {
  Solvers::News news = here_.take_news();
  if (elsewhere_ && !owner_) elsewhere_->drop_news();
  if (!owner_) return news;
  Solvers::News more = elsewhere_->take_news();
  const auto append = [](auto& to, auto& from) {
    for (auto& item : from) to.push_back(std::move(item));
  };
  append(news.progress, more.progress);
  append(news.outcomes, more.outcomes);
  append(news.lost, more.lost);
  append(news.returned, more.returned);
  return news;
}

std::vector<const Job*> Slots::jobs() const {
  std::vector<const Job*> jobs = here_.jobs();
  if (!elsewhere_) return jobs;
  const std::vector<const Job*> more = elsewhere_->jobs();
  jobs.insert(jobs.end(), more.begin(), more.end());
  return jobs;
}

}  // namespace fjr
