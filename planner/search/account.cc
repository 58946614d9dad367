#include "planner/search/account.h"

#include "common/field_count.h"

namespace fjr {
namespace {

consteval std::size_t visited_fallbacks() {
  std::size_t count = 0;
  Fallbacks fallbacks;
  visit_fallbacks(fallbacks, [&](const char*, int&) { ++count; });
  return count;
}
static_assert(visited_fallbacks() == field_count<Fallbacks>(), "visit_fallbacks() leaves out a member");

}  // namespace

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
