#include "planner/search/account.h"

namespace fjr {

Fallbacks& Fallbacks::operator+=(const Fallbacks& other) {
  std::vector<int> counts;
  visit_fallbacks(other, [&](const char*, int count) { counts.push_back(count); });
  auto next = counts.begin();
  visit_fallbacks(*this, [&](const char*, int& count) { count += *next++; });
  return *this;
}

Account& Account::operator+=(const Account& other) {
  stages.insert(stages.end(), other.stages.begin(), other.stages.end());
  iterations += other.iterations;
  cost += other.cost;
  work += other.work;
  fallbacks += other.fallbacks;
  cut_by_work = cut_by_work || other.cut_by_work;
  add_time_of(other);
  return *this;
}

void Account::add_time_of(const Account& other) {
  for (const auto& [part, seconds] : other.timing) timing[part] += seconds;
  cpu_of_others += other.cpu_of_others;
}

}  // namespace fjr
